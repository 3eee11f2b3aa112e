// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/training_report.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "frontend/error.h"
#include "frontend/fabmap/chow_liu_training.h"
#include "frontend/fabmap/tree_likelihood.h"
#include "tests/support/descriptor_sampling.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

using fabloop::testing_support::random_tree;
using fabloop::testing_support::TreeSampler;
using ::testing::HasSubstr;

TEST(TrainingReport, CountsWords) {
  // Word 0 is always seen (but for the image without words it would be), 1 in one image, 2 in two, 3 never.
  const TrainingReport report = count_words({{{0, 1, 2}}, {{0, 2}}, {{0}}}, 4);
  EXPECT_EQ(report.num_images, 3u);
  EXPECT_EQ(report.num_words, 4u);
  EXPECT_EQ(report.num_words_always_seen, 1u);
  EXPECT_EQ(report.num_words_in_one_image, 1u);
  EXPECT_EQ(report.num_words_never_seen, 1u);
  EXPECT_EQ(report.min_words_per_image, 1u);
  EXPECT_EQ(report.median_words_per_image, 2u);
  EXPECT_EQ(report.max_words_per_image, 3u);
  EXPECT_EQ(report.mean_words_per_image, 2.0);
  EXPECT_EQ(report.num_images_without_words, 0u);
  EXPECT_EQ(count_words({{}, {{1}}}, 2).num_images_without_words, 1u);
}

TEST(TrainingReport, MeasuresDistances) {
  const Vocabulary vocabulary{(cv::Mat_<float>(3, 2) << 0, 0, 4, 0, 0, 3)};
  const cv::Mat descriptors = (cv::Mat_<float>(2, 2) << 0, 1, 4, 3);
  const WordDistances distances = measure_distances(vocabulary, descriptors);
  EXPECT_NEAR(distances.to_word, 2.0, 1e-6) << "1 and 3";
  EXPECT_NEAR(distances.between_words, 10.0 / 3.0, 1e-6) << "3, 4 and 3";
  EXPECT_EQ(measure_distances({vocabulary.words.rowRange(0, 1)}, descriptors).between_words, 0.0);
}

TEST(TrainingReport, ComesBackFromJson) {
  TrainingReport report = count_words({{{0, 1, 2}}, {{0, 2}}, {{0}}}, 4);
  report.entropy = 1.0 / 3.0;
  report.self_test.num_recalled = 12;
  const TrainingReport read = training_report_from_json(to_json(report));
  EXPECT_EQ(to_json(read), to_json(report));
  EXPECT_EQ(read.entropy, report.entropy);
  EXPECT_EQ(read.self_test.num_recalled, 12u);
  EXPECT_THROW(training_report_from_json("{}"), InputError);
  EXPECT_THROW(training_report_from_json("{"), InputError);
  EXPECT_THAT(to_json_with_findings(report), HasSubstr("\"verdict\": \"few: "));
}

TEST(TrainingReport, SaysWhatIsWrong) {
  TrainingReport report = count_words({{{0, 1, 2}}, {{0, 2}}, {{0}}}, 4);
  for (const Finding& finding : findings(report)) {
    EXPECT_FALSE(finding.figure.empty());
    EXPECT_EQ(finding.verdict == "good", finding.grade == Grade::Good) << finding.figure;
  }
  const auto all = findings(report);
  const auto found = std::find_if(
      all.begin(), all.end(), [](const Finding& finding) { return finding.figure == "words in one image only: 1 of 4 (25 %)"; });
  ASSERT_NE(found, all.end());
  EXPECT_EQ(found->grade, Grade::Fair);
}

TEST(TreeLikelihood, IsTheSumOverAllWords) {
  const ChowLiuTree tree = random_tree(40, 0.2, 3);
  const TreeLikelihood likelihood(tree);
  for (const Observation& observation : TreeSampler(tree, 5).draw(20)) {
    const auto is_seen = [&](WordId word) {
      return std::binary_search(observation.words.begin(), observation.words.end(), word);
    };
    double expected = 0.0;
    for (WordId word = 0; word < tree.num_words(); ++word) {
      const ChowLiuNode& node = tree.nodes[word];
      const double p = !node.parent ? node.p : is_seen(*node.parent) ? node.p_if_parent : node.p_if_no_parent;
      expected += std::log(is_seen(word) ? p : 1.0 - p);
    }
    EXPECT_NEAR(likelihood(observation), expected, 1e-10);
  }
}

TEST(SelfTest, SeesThatATreeHelpsWhereWordsDepend) {
  ChowLiuTree tree{{{std::nullopt, 0.3, 0.3, 0.3}}};  // a chain in which every word has p = 0.3
  for (WordId word = 1; word < 30; ++word) tree.nodes.push_back({word - 1, 0.3, 0.8, 0.06 / 0.7});
  const std::vector<Observation> observations = TreeSampler(tree, 1).draw(400);
  const SelfTest test = self_test(tree, observations, observations, hold_out(observations, 30));
  EXPECT_EQ(test.num_held_out, 80u);
  EXPECT_GT(test.tree_log_likelihood, test.naive_bayes_log_likelihood + 1.0);
  const std::vector<Observation> independent = TreeSampler(naive_bayes(tree), 1).draw(400);
  ChowLiuOptions whole_tree;
  whole_tree.min_mutual_information = 0.0;
  const SelfTest other = self_test(tree, independent, independent, hold_out(independent, 30, whole_tree));
  EXPECT_LT(other.tree_log_likelihood, other.naive_bayes_log_likelihood) << "the tree has learnt chance";
}

TEST(SelfTest, CountsWhatIsFoundAgain) {
  const ChowLiuTree tree = random_tree(60, 0.2, 1);
  std::vector<Observation> observations = TreeSampler(tree, 1).draw(30);
  for (std::size_t i = 1; i < observations.size(); i += 2) observations[i] = observations[i - 1];  // pairs of equal images
  SelfTestOptions options;
  options.max_queries = 20;
  const SelfTest test = self_test(tree, observations, observations, {}, options);
  EXPECT_EQ(test.num_recall_queries, 20u);
  EXPECT_EQ(test.num_neighbours_first, 20u) << "the equal one is next to it";
  EXPECT_LT(test.num_recalled, 20u) << "the second of a pair cannot be told from the first";
  EXPECT_GT(test.num_recalled, 4u);
}

TEST(SelfTest, TakesFewImagesAndNone) {
  const ChowLiuTree tree = random_tree(10, 0.2, 1);
  EXPECT_EQ(self_test(tree, {{{1}}}, {{{1}}}, {}).num_recall_queries, 0u);
  const std::vector<Observation> empty(12);
  const SelfTest without_words = self_test(tree, empty, empty, hold_out(empty, 10));
  EXPECT_EQ(without_words.num_recall_queries, 0u);
  EXPECT_EQ(without_words.num_held_out, 2u);
}

}  // namespace
}  // namespace fabloop
