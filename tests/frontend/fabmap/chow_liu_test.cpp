// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "frontend/error.h"
#include "frontend/fabmap/chow_liu_training.h"
#include "frontend/fabmap/chow_liu_tree.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

using testing::random_tree;
using testing::TreeSampler;

constexpr double kRounding = 1e-12;

/// A tree whose links are strong enough to be found from a few thousand samples.
ChowLiuTree strongly_linked_tree(std::size_t num_words) {
  ChowLiuTree tree;
  std::mt19937_64 generator(3);
  tree.nodes.push_back({std::nullopt, 0.3, 0.3, 0.3});
  while (tree.num_words() < num_words) {
    tree.nodes.push_back({static_cast<WordId>(generator() % tree.num_words()), 0.3, 0.8, 0.06 / 0.7});
  }
  return tree;
}

bool are_equal(const ChowLiuTree& a, const ChowLiuTree& b) {
  return std::equal(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end(), [](const auto& x, const auto& y) {
    return x.parent == y.parent && x.p == y.p && x.p_if_parent == y.p_if_parent && x.p_if_no_parent == y.p_if_no_parent;
  });
}

/// Mutual information of two words as training sees it.
double link(const std::vector<Observation>& observations, WordId a, WordId b) {
  std::vector<Observation> pair;
  for (const Observation& observation : observations) {
    Observation& projected = pair.emplace_back();
    for (const WordId word : observation.words) {
      if (word == a) projected.words.push_back(0);
      if (word == b) projected.words.push_back(1);
    }
  }
  return train_chow_liu_tree(pair, 2).mutual_information;
}

TEST(ChowLiu, RecoversAKnownTreeFromItsSamples) {
  const ChowLiuTree truth = strongly_linked_tree(60);
  const ChowLiuTree tree = train_chow_liu_tree(TreeSampler(truth, 1).draw(4000), 60).tree;
  constexpr double kSampling = 0.06;  // Five standard deviations of a frequency of 0.8 in 1,200 images.
  for (WordId word = 0; word < 60; ++word) {
    EXPECT_EQ(tree.nodes[word].parent, truth.nodes[word].parent) << word;
    EXPECT_NEAR(tree.nodes[word].p, truth.nodes[word].p, kSampling);
    EXPECT_NEAR(tree.nodes[word].p_if_parent, truth.nodes[word].p_if_parent, kSampling);
    EXPECT_NEAR(tree.nodes[word].p_if_no_parent, truth.nodes[word].p_if_no_parent, kSampling);
  }
}

TEST(ChowLiu, FindsNoLinkBetweenIndependentWords) {
  // Words 0, 1, 2 are seen in 10 %, 1 % and 50 % of the images, in every combination as often as chance has it. Word 3 follows
  // word 0 half of the time.
  std::vector<Observation> observations;
  for (unsigned i = 0; i < 4000; ++i) {
    Observation& observation = observations.emplace_back();
    if (i % 10 == 0) observation.words.push_back(0);
    if (i / 10 % 100 == 0) observation.words.push_back(1);
    if (i / 1000 % 2 == 0) observation.words.push_back(2);
    if (i % 20 == 0) observation.words.push_back(3);
  }
  const double linked = link(observations, 0, 3);
  for (const auto& [a, b] : {std::pair{0u, 1u}, {0u, 2u}, {1u, 2u}}) EXPECT_LT(link(observations, a, b), 1e-3 * linked);
}

TEST(ChowLiu, DoesNotDependOnTheOrderOfImages) {
  std::vector<Observation> observations = TreeSampler(random_tree(80, 0.1, 4), 4).draw(200);
  const ChowLiuResult result = train_chow_liu_tree(observations, 80);
  std::shuffle(observations.begin(), observations.end(), std::mt19937_64(5));
  const ChowLiuResult shuffled = train_chow_liu_tree(observations, 80);
  EXPECT_TRUE(are_equal(result.tree, shuffled.tree));
  EXPECT_EQ(result.mutual_information, shuffled.mutual_information);
}

TEST(ChowLiu, TakesAllProbabilitiesFromOneTable) {
  const std::vector<Observation> observations = TreeSampler(random_tree(40, 0.2, 6), 6).draw(30);
  const ChowLiuTree tree = train_chow_liu_tree(observations, 40).tree;
  for (const ChowLiuNode& node : tree.nodes) {
    if (!node.parent) continue;
    const double parent_p = tree.nodes[*node.parent].p;
    EXPECT_NEAR(node.p_if_parent * parent_p + node.p_if_no_parent * (1.0 - parent_p), node.p, kRounding);
  }
}

TEST(ChowLiu, NeverCallsTheUnseenImpossible) {
  // Word 0 is always seen, word 2 never.
  const std::vector<Observation> observations = {{{0, 1}}, {{0}}, {{0, 1, 3}}};
  EXPECT_NO_THROW(validate(train_chow_liu_tree(observations, 4).tree, "tree"));
  EXPECT_NO_THROW(validate(train_chow_liu_tree({{}, {}}, 3).tree, "tree"));
  EXPECT_NO_THROW(validate(train_chow_liu_tree({{{0, 1}}}, 2).tree, "tree"));
  EXPECT_NO_THROW(validate(train_chow_liu_tree({{{0}}}, 1).tree, "tree"));
}

TEST(ChowLiu, CutsWeakLinks) {
  const std::vector<Observation> observations = TreeSampler(strongly_linked_tree(20), 2).draw(500);
  ChowLiuOptions options;
  options.min_mutual_information = std::numeric_limits<double>::infinity();
  const ChowLiuTree cut = train_chow_liu_tree(observations, 20, options).tree;
  EXPECT_TRUE(are_equal(cut, naive_bayes(train_chow_liu_tree(observations, 20).tree)));
  EXPECT_EQ(parents_first(cut).size(), 20u);
}

TEST(ChowLiu, RefusesWhatIsNoTraining) {
  EXPECT_THROW(train_chow_liu_tree({}, 3), InputError);
  EXPECT_THROW(train_chow_liu_tree({{}}, 0), InputError);
  EXPECT_THROW(train_chow_liu_tree({{{3}}}, 3), InputError);
  ChowLiuOptions options;
  options.pseudo_count = 0.0;
  EXPECT_THROW(train_chow_liu_tree({{}}, 3, options), InputError);
}

TEST(ChowLiu, RefusesTreesThatAreNone) {
  const ChowLiuNode good = {std::nullopt, 0.2, 0.2, 0.2};
  EXPECT_NO_THROW(validate(ChowLiuTree{{good, good}}, "tree"));
  EXPECT_THROW(validate(ChowLiuTree{}, "tree"), InputError);
  EXPECT_THROW(validate(ChowLiuTree{{good, {7, 0.2, 0.2, 0.2}}}, "tree"), InputError);
  EXPECT_THROW(validate(ChowLiuTree{{good, {1, 0.2, 0.2, 0.2}}}, "tree"), InputError);
  EXPECT_THROW(validate(ChowLiuTree{{good, {2, 0.2, 0.2, 0.2}, {1, 0.2, 0.2, 0.2}}}, "tree"), InputError);
  for (const double bad : {0.0, 1.0, -0.1, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(validate(ChowLiuTree{{good, {0, 0.2, bad, 0.2}}}, "tree"), InputError);
  }
}

}  // namespace
}  // namespace fabloop
