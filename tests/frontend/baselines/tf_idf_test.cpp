// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/baselines/tf_idf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace fabloop {
namespace {

constexpr double kRounding = 1e-12;

/// Words of which the first is in every second, the others in every fourth and every eighth training image.
std::vector<double> idf() {
  ChowLiuTree tree;
  tree.nodes = {{std::nullopt, 0.5, 0.5, 0.5}, {std::nullopt, 0.25, 0.25, 0.25}, {std::nullopt, 0.125, 0.125, 0.125}};
  return inverse_document_frequencies(tree);
}

TEST(TfIdf, RareWordsCountMore) {
  const std::vector<double> weights = idf();
  ASSERT_EQ(weights.size(), 3u);
  EXPECT_NEAR(weights[0], std::log(2.0), kRounding);
  EXPECT_NEAR(weights[1], std::log(4.0), kRounding);
  EXPECT_NEAR(weights[2], std::log(8.0), kRounding);
}

TEST(TfIdf, ABagHoldsFrequenciesTimesRarityWithNormOne) {
  // Word 0 twice (2 log 2) and word 2 once (3 log 2): two and three fifths.
  const BagOfWords bag = tf_idf_bag({2, 0, 0}, idf());
  ASSERT_EQ(bag.size(), 2u);
  EXPECT_EQ(bag[0].word, 0u);
  EXPECT_NEAR(bag[0].weight, 0.4, kRounding);
  EXPECT_EQ(bag[1].word, 2u);
  EXPECT_NEAR(bag[1].weight, 0.6, kRounding);
}

TEST(TfIdf, TheScoreIsThatOfDbow2ComputedByHand) {
  const BagOfWords v = tf_idf_bag({0, 0, 2}, idf());  // 0.4, 0, 0.6
  const BagOfWords w = tf_idf_bag({0, 1}, idf());     // 1/3, 2/3, 0
  // |v - w| = 1/15 + 2/3 + 3/5 = 4/3, so the score is 1 - 2/3.
  EXPECT_NEAR(l1_score(v, w), 1.0 / 3.0, kRounding);
  EXPECT_NEAR(l1_score(w, v), 1.0 / 3.0, kRounding);
}

TEST(TfIdf, TheScoreEqualsItsDefinitionOnRandomBags) {
  std::mt19937 random(3);
  std::vector<double> weights(40);
  for (double& weight : weights) weight = 0.1 + static_cast<double>(random() % 100) / 20.0;
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<WordId> words[2];
    for (auto& image : words) {
      for (std::size_t i = 0; i < 1 + random() % 60; ++i) image.push_back(static_cast<WordId>(random() % weights.size()));
    }
    const BagOfWords v = tf_idf_bag(words[0], weights), w = tf_idf_bag(words[1], weights);
    std::vector<double> difference(weights.size(), 0.0);
    for (const WeightedWord& word : v) difference[word.word] += word.weight;
    for (const WeightedWord& word : w) difference[word.word] -= word.weight;
    double norm = 0.0;
    for (const double d : difference) norm += std::abs(d);
    EXPECT_NEAR(l1_score(v, w), 1.0 - 0.5 * norm, kRounding);
  }
}

TEST(TfIdf, AnImageIsAllLikeItselfAndNothingLikeOneWithoutWords) {
  const BagOfWords v = tf_idf_bag({0, 1, 1, 2}, idf());
  EXPECT_NEAR(l1_score(v, v), 1.0, kRounding);
  EXPECT_EQ(l1_score(v, tf_idf_bag({}, idf())), 0.0);
}

}  // namespace
}  // namespace fabloop
