// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/match_consistency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "frontend/features/feature_extractor.h"

namespace fabloop {
namespace {

/// Matches i to i, the first `num_true` of which turn and grow alike but for some noise; the others at random.
struct Pair {
  Features query, match;
  std::vector<Match> matches;
};

Pair make_pair(std::uint64_t seed, int num_true, int num_false, double turn_deg, double log2_growth, double noise_deg) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> angle(0, 360), octaves(-2.5, 2.5);
  std::normal_distribution<double> normal(0, 1);
  Pair pair;
  for (int i = 0; i < num_true + num_false; ++i) {
    const bool is_true = i < num_true;
    const double from = angle(random);
    const double to = is_true ? std::fmod(from + turn_deg + noise_deg * normal(random) + 720, 360) : angle(random);
    const double growth = is_true ? log2_growth + 0.1 * normal(random) : octaves(random);
    pair.query.keypoints.emplace_back(10.0F, 10.0F, 8.0F, static_cast<float>(from));
    pair.match.keypoints.emplace_back(10.0F, 10.0F, static_cast<float>(8.0 * std::exp2(growth)), static_cast<float>(to));
    pair.matches.push_back({i, i, 0.5F});
  }
  std::shuffle(pair.matches.begin(), pair.matches.end(), random);
  return pair;
}

TEST(ViewChange, IsFoundAmongMoreFalseThanTrueMatches) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const double turn = 3.6 * static_cast<double>(seed) / 2.0, growth = 0.01 * static_cast<double>(seed) - 1.0;
    const Pair pair = make_pair(seed, 80, 160, turn, growth, 8);
    const ViewChange change = view_change(pair.query, pair.match, pair.matches);
    ASSERT_TRUE(change.turn_deg && change.log2_growth) << seed;
    EXPECT_LT(std::abs(std::remainder(change.turn_deg->value - turn, 360.0)), 6) << seed;  // within the noise of one angle
    EXPECT_NEAR(change.log2_growth->value, growth, 0.25) << seed;                          // a bin of the histogram
    EXPECT_GE(change.turn_deg->value, 0.0);
    EXPECT_LT(change.turn_deg->value, 360.0);
  }
}

TEST(ViewChange, IsSeldomSeenInFalseMatches) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Pair pair = make_pair(seed, 0, 100, 0, 0, 0);
    found += view_change(pair.query, pair.match, pair.matches).turn_deg.has_value();
  }
  EXPECT_LE(found, 4);  // the best of several bins exceeds four deviations more often than one in 30,000
}

TEST(MatchConsistency, KeepsTheTrueAndDropsMostOfTheFalse) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Pair pair = make_pair(seed, 80, 160, 180, 0, 8);
    const auto kept = consistent_only(pair.query, pair.match, pair.matches);
    EXPECT_EQ(std::count_if(kept.begin(), kept.end(), [](const Match& m) { return m.query < 80; }), 80);
    // By chance a quarter have the turn and less than a half the growth.
    EXPECT_LT(kept.size(), 80u + 40u);
  }
}

TEST(MatchConsistency, RankingLosesNoneAndPutsTheConsistentFirst) {
  const Pair pair = make_pair(1, 60, 60, 270, 0.5, 8);
  const auto ranked = consistent_first(pair.query, pair.match, pair.matches);
  const auto kept = consistent_only(pair.query, pair.match, pair.matches);
  ASSERT_EQ(ranked.size(), pair.matches.size());
  ASSERT_LT(kept.size(), ranked.size());
  for (std::size_t i = 0; i < kept.size(); ++i) EXPECT_EQ(ranked[i].query, kept[i].query);
}

TEST(MatchConsistency, DoesNothingWhereAnglesAndSizesTellNothing) {
  Pair pair = make_pair(1, 60, 60, 90, 0.0, 8);
  for (Features* features : {&pair.query, &pair.match}) {
    for (cv::KeyPoint& keypoint : features->keypoints) keypoint.angle = -1, keypoint.size = 7;
  }
  EXPECT_FALSE(view_change(pair.query, pair.match, pair.matches).turn_deg);
  EXPECT_EQ(consistent_only(pair.query, pair.match, pair.matches).size(), pair.matches.size());
  EXPECT_TRUE(consistent_only(pair.query, pair.match, {}).empty());
}

/// Blobs of many sizes.
cv::Mat make_texture(std::uint64_t seed) {
  cv::Mat1f sum(300, 400, 0.0F);
  cv::RNG random(seed);
  for (const int cells : {10, 25, 60, 130}) {
    cv::Mat1f noise(cells, cells), scaled;
    random.fill(noise, cv::RNG::UNIFORM, 0.0, 1.0);
    cv::resize(noise, scaled, sum.size(), 0, 0, cv::INTER_CUBIC);
    sum += scaled;
  }
  cv::Mat gray;
  cv::normalize(sum, gray, 0, 255, cv::NORM_MINMAX, CV_8U);
  return gray;
}

TEST(MatchConsistency, TellsAReturnStripFromItsImages) {
  const cv::Mat there = make_texture(1);
  cv::Mat back;
  cv::rotate(there, back, cv::ROTATE_180);
  FeatureOptions options;
  options.max_features = 300;
  const Features query = FeatureExtractor(options).extract(there), match = FeatureExtractor(options).extract(back);
  const auto matches = match_features(query, match, {.max_ratio = 0.95});
  const ViewChange change = view_change(query, match, matches);
  ASSERT_TRUE(change.turn_deg && change.log2_growth);
  EXPECT_NEAR(change.turn_deg->value, 180, 5);
  EXPECT_NEAR(change.log2_growth->value, 0, 0.1);
  const auto is_true = [&](const Match& m) {
    const cv::Point2f a = query.keypoints[static_cast<std::size_t>(m.query)].pt,
                      b = match.keypoints[static_cast<std::size_t>(m.match)].pt;
    return std::abs(a.x + b.x - 399) < 2 && std::abs(a.y + b.y - 299) < 2;
  };
  const auto kept = consistent_only(query, match, matches);
  const auto num_true = std::count_if(matches.begin(), matches.end(), is_true);
  EXPECT_GT(num_true, 100);
  EXPECT_GE(std::count_if(kept.begin(), kept.end(), is_true), 0.99 * static_cast<double>(num_true));
}

}  // namespace
}  // namespace fabloop
