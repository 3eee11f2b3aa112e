// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/baselines/place_scores.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "frontend/baselines/score_folder.h"
#include "frontend/baselines/tf_idf.h"
#include "frontend/npy.h"
#include "frontend/recognition/recognition_run.h"
#include "tests/frontend/sequence/temporary_folder.h"
#include "tests/frontend/word_model.h"

namespace fabloop {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::kNumWords;
using testing_support::model_of_words;

constexpr std::size_t kRecent = 2;

/// Images of places that show six words of their own, and each image one of its own besides; frames are 0, 2, 4, ...
std::vector<ImageDigest> digests_at(const std::vector<WordId>& places) {
  std::vector<ImageDigest> images;
  for (const WordId place : places) {
    ImageDigest image;
    image.frame = 2 * images.size();
    image.time_ns = static_cast<std::int64_t>(images.size());
    for (WordId word = 0; word < 6; ++word) image.words.push_back(6 * place + word);
    image.words.push_back(static_cast<WordId>((7 * images.size()) % kNumWords));
    image.vlad = cv::Mat::zeros(1, 10, CV_32F);
    image.vlad.at<float>(static_cast<int>(place)) = 1.0F;
    image.small = cv::Mat1f(8, 8, static_cast<float>(place));
    images.push_back(image);
  }
  return images;
}

const std::vector<WordId> kRoute = {0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 4, 5};

PlaceScoreOptions few_recent() {
  PlaceScoreOptions options;
  options.num_recent_excluded = kRecent;
  options.sequence.length = 3;
  options.sequence.contrast_window = 6;
  return options;
}

/// The revisits of kRoute are the true matches.
GroundTruth truth_of_route() {
  const auto at = [](std::size_t query, std::size_t match) {
    if (query - match <= 2 * kRecent) return MatchTruth::NotJudged;
    return kRoute[query / 2] == kRoute[match / 2] ? MatchTruth::True : MatchTruth::False;
  };
  return {2 * kRoute.size(), 2 * kRoute.size(), at, true, "revisits"};
}

TEST(PlaceScores, EveryMethodFindsAnEasyRevisitThroughTheSameJudge) {
  const Model model = model_of_words();
  for (const PlaceMethod method : all_place_methods()) {
    const ScoreTable table = score_sequence(method, &model, digests_at(kRoute), few_recent());
    ASSERT_EQ(table.rows.size(), kRoute.size());
    EXPECT_EQ(table.rows[1].scores.size(), 0u) << "recent places are left out";
    EXPECT_EQ(table.rows[7].scores.size(), 7 - kRecent);
    EXPECT_EQ(table.label, label_of(method));
    const PrecisionRecall judged = judge_scores(table, truth_of_route(), 10);
    ASSERT_TRUE(judged.curve.has_value());
    EXPECT_EQ(judged.num_queries_with_true_match, 6u);
    // Sequences need two images more before they find anything.
    const double expected = method == PlaceMethod::SeqSlam ? 4.0 / 6.0 : 1.0;
    EXPECT_NEAR(judged.curve->recall_at_full_precision, expected, 1e-12) << to_string(method);
  }
}

TEST(PlaceScores, FabMapScoresAreTheLogOddsOfRecognition) {
  const Model model = model_of_words();
  const std::vector<ImageDigest> images = digests_at(kRoute);
  std::vector<ObservedImage> observed;
  for (const ImageDigest& image : images) observed.push_back({image.frame, image.time_ns, observation_of(image.words)});
  RecognitionOptions options;
  options.num_recent_excluded = kRecent;
  options.max_matches = images.size();
  const Recognition recognition = recognize_sequence(model, observed, options);
  const ScoreTable table = score_sequence(PlaceMethod::FabMap, &model, images, few_recent());
  for (std::size_t i = 0; i < images.size(); ++i) {
    for (const PlaceMatch& match : recognition.images[i].matches) {
      EXPECT_EQ(table.rows[i].scores.at(match.place), match.log_odds) << i;
    }
  }
}

TEST(PlaceScores, BagsAreScoredPairByPair) {
  const Model model = model_of_words();
  const std::vector<ImageDigest> images = digests_at(kRoute);
  const ScoreTable table = score_sequence(PlaceMethod::TfIdf, &model, images, few_recent());
  const std::vector<double> idf = inverse_document_frequencies(model.tree);
  EXPECT_EQ(table.rows[9].scores[3], l1_score(tf_idf_bag(images[9].words, idf), tf_idf_bag(images[3].words, idf)));
}

TEST(PlaceScores, InAMapEveryImageIsAPlaceForEveryQuery) {
  const Model model = model_of_words();
  const std::vector<ImageDigest> map = digests_at({0, 1, 2, 3, 4, 5, 6, 7}), queries = digests_at({2, 3, 4, 5});
  for (const PlaceMethod method : all_place_methods()) {
    const ScoreTable table = score_in_map(method, &model, map, queries, few_recent());
    ASSERT_EQ(table.rows.size(), 4u);
    for (const ScoreRow& row : table.rows) EXPECT_EQ(row.scores.size(), 8u) << to_string(method);
    const ScoredQuery last = scored_queries(table, 1).back();
    ASSERT_EQ(last.matches.size(), 1u) << to_string(method);
    EXPECT_EQ(last.matches[0].place, 5u) << to_string(method);
  }
}

TEST(PlaceScores, AMethodThatNeedsAModelSaysSo) {
  EXPECT_THAT(input_error_of([] { score_sequence(PlaceMethod::Vlad, nullptr, digests_at(kRoute)); }),
              HasSubstr("vlad needs a model"));
  EXPECT_THAT(input_error_of([] { ImageDigester({PlaceMethod::TfIdf}, nullptr); }), HasSubstr("tf-idf needs a model"));
  EXPECT_NO_THROW(ImageDigester({PlaceMethod::SeqSlam}, nullptr));
}

TEST(ScoreFile, TheScoresOfAFileAreJudgedAsTheMethodThatWroteThem) {
  const TemporaryFolder folder;
  const Model model = model_of_words();
  const std::vector<ImageDigest> images = digests_at(kRoute);
  std::vector<std::size_t> frames;
  for (const ImageDigest& image : images) frames.push_back(image.frame);
  for (const PlaceMethod method : all_place_methods()) {
    const ScoreTable table = score_sequence(method, &model, images, few_recent());
    const auto run = folder.path() / std::string(to_string(method));
    OutputFolder output(run);
    write_scores(output, {.method = "x", .table = table, .sequence = "s", .map = "", .max_matches = images.size()});
    ScoreTable read = empty_scores(frames, frames, true, kRecent);
    read_scores(run / "hypotheses.csv", read);
    ASSERT_EQ(read.rows.size(), table.rows.size());
    for (std::size_t i = 0; i < table.rows.size(); ++i) EXPECT_EQ(read.rows[i].scores, table.rows[i].scores) << to_string(method);
    NpyReader matrix(run / "scores.npy");
    EXPECT_EQ(matrix.num_rows(), images.size());
    EXPECT_EQ(matrix.num_columns(), images.size());
  }
}

TEST(ScoreFile, PairsThatAreNotAskedForArePassedOver) {
  const TemporaryFolder folder;
  ScoreTable table = empty_scores({0, 1, 2}, {0, 1, 2}, true, 1);
  const auto file = folder.write("full.csv", "match,query,note,score\n0,2,a,0.5\n2,0,b,0.7\n1,2,c,0.9\n");
  read_scores(file, table);
  EXPECT_THAT(table.rows[2].scores, ElementsAre(0.5)) << "place 1 is too recent";
  EXPECT_TRUE(table.rows[0].scores.empty());
  EXPECT_EQ(table.label, "scores of full.csv");
}

TEST(ScoreFile, BadFilesNameTheLine) {
  const TemporaryFolder folder;
  const auto error_of = [&](const std::string& text) {
    const auto file = folder.write("scores.csv", text);
    return input_error_of([&] {
      ScoreTable table = empty_scores({0, 1, 2}, {0, 1, 2}, true, 0);
      read_scores(file, table);
    });
  };
  EXPECT_THAT(error_of(""), HasSubstr("no head line"));
  EXPECT_THAT(error_of("query,match\n"), HasSubstr("no column 'score'"));
  EXPECT_THAT(error_of("query,match,score\n2,7,1\n"), HasSubstr("scores.csv:2: match 7 is no image"));
  EXPECT_THAT(error_of("query,match,score\n2,1,nan\n"), HasSubstr("scores.csv:2"));
  EXPECT_THAT(error_of("query,match,score\n2,1,1\n2,1,1\n"), HasSubstr("scores.csv:3: has a pair that came before"));
  EXPECT_THAT(error_of("query,match,score\n2,1\n"), HasSubstr("scores.csv:2: has 2 columns"));
}

TEST(PlaceMethod, NamesAndLabelsSayWhatAMethodIs) {
  for (const PlaceMethod method : all_place_methods()) EXPECT_EQ(place_method_named(to_string(method)), method);
  EXPECT_FALSE(place_method_named("dbow").has_value());
  EXPECT_THAT(label_of(PlaceMethod::SeqSlam), HasSubstr("not the authors' code"));
}

}  // namespace
}  // namespace fabloop
