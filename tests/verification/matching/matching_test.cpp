// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/matching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "frontend/features/descriptor_distances.h"
#include "tests/support/enlarged_view.h"
#include "tests/verification/two_view_world.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

bool is_same_spot(const cv::KeyPoint& a, const cv::KeyPoint& b, double distance_px) {
  return std::abs(a.pt.x - b.pt.x) < distance_px && std::abs(a.pt.y - b.pt.y) < distance_px;
}

cv::Mat1f squared_distances(const Features& query, const Features& match) {
  if (query.descriptors.type() == CV_32F) return PackedDescriptors(match.descriptors).squared_distances(query.descriptors);
  cv::Mat1f distances(query.descriptors.rows, match.descriptors.rows);
  for (int q = 0; q < distances.rows; ++q) {
    for (int m = 0; m < distances.cols; ++m) {
      const auto count = static_cast<float>(cv::norm(query.descriptors.row(q), match.descriptors.row(m), cv::NORM_HAMMING));
      distances(q, m) = count * count;
    }
  }
  return distances;
}

/// The definition, word by word, from the table of all distances.
std::vector<Match> matches_by_definition(const Features& query, const Features& match, const MatchingOptions& options) {
  const cv::Mat1f distances = squared_distances(query, match);
  std::vector<char> is_given(match.keypoints.size(), 0);
  std::vector<Match> all;
  for (int q = 0; q < distances.rows; ++q) {
    const auto best = std::min_element(distances[q], distances[q] + distances.cols) - distances[q];
    const float distance = distances(q, static_cast<int>(best));
    bool is_mutual = is_given[static_cast<std::size_t>(best)] == 0;
    for (int other = 0; other < distances.rows; ++other) is_mutual &= distances(other, static_cast<int>(best)) >= distance;
    if (!is_mutual) continue;
    is_given[static_cast<std::size_t>(best)] = 1;
    float second = kInfinity;
    for (int m = 0; m < distances.cols; ++m) {
      const auto& keypoint = match.keypoints[static_cast<std::size_t>(m)];
      const bool is_rival =
          m != best && !is_same_spot(keypoint, match.keypoints[static_cast<std::size_t>(best)], options.same_spot_px);
      if (is_rival) second = std::min(second, distances(q, m));
    }
    const float ratio = second > 0 ? std::sqrt(distance / second) : 1.0F;
    if (ratio <= options.max_ratio) all.push_back({q, static_cast<int>(best), ratio});
  }
  std::stable_sort(all.begin(), all.end(), [](const Match& a, const Match& b) { return a.ratio < b.ratio; });
  std::vector<Match> kept;
  for (const Match& candidate : all) {
    const auto shows = [&](int feature) { return query.keypoints[static_cast<std::size_t>(feature)]; };
    const bool is_taken = std::any_of(kept.begin(), kept.end(), [&](const Match& other) {
      return is_same_spot(shows(candidate.query), shows(other.query), options.same_spot_px);
    });
    if (!is_taken) kept.push_back(candidate);
  }
  return kept;
}

void expect_same_bytes(const std::vector<Match>& found, const std::vector<Match>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].query, expected[i].query) << i;
    EXPECT_EQ(found[i].match, expected[i].match) << i;
    EXPECT_EQ(std::memcmp(&found[i].ratio, &expected[i].ratio, sizeof(float)), 0) << i;
  }
}

struct TwoFeatures {
  Features query, match;
};

/// Features on whole pixels of a small image, several a spot, of few different descriptors: rich in ties.
Features crowded_features(std::mt19937& random, int count, int num_columns, bool of_bits) {
  Features features;
  std::uniform_int_distribution<int> pixel(0, 24), number(0, 3), byte(0, 255), coin(0, 3);
  if (of_bits) features.descriptor_kind = DescriptorKind::Orb;
  features.descriptors.create(count, num_columns, of_bits ? CV_8U : CV_32F);
  for (int i = 0; i < count; ++i) {
    features.keypoints.emplace_back(static_cast<float>(pixel(random)), static_cast<float>(pixel(random)), 3.0F);
    for (int c = 0; c < num_columns; ++c) {
      if (of_bits) features.descriptors.at<std::uint8_t>(i, c) = static_cast<std::uint8_t>(byte(random));
      if (!of_bits) features.descriptors.at<float>(i, c) = static_cast<float>(number(random));
    }
    if (i > 0 && coin(random) == 0) features.descriptors.row(i - 1).copyTo(features.descriptors.row(i));
  }
  return features;
}

/// Most rows of the one are rows of the other with a little noise.
void make_alike(std::mt19937& random, const Features& match, Features& query) {
  const int count = std::min(match.descriptors.rows, query.descriptors.rows);
  std::uniform_int_distribution<int> row(0, match.descriptors.rows - 1), column(0, match.descriptors.cols - 1);
  for (int i = 0; i < count / 2; ++i) {
    match.descriptors.row(row(random)).copyTo(query.descriptors.row(i));
    if (query.descriptors.type() == CV_32F) query.descriptors.at<float>(i, column(random)) += 0.5F;
    if (query.descriptors.type() == CV_8U) query.descriptors.at<std::uint8_t>(i, column(random)) ^= 1;
  }
}

TEST(Matching, IsItsDefinitionByteForByte) {
  std::mt19937 random(7);
  for (const bool of_bits : {false, true}) {
    // Below and beyond the panels, tiles and blocks that the search works in; ORB's, AKAZE's, BRISK's and odd bytes.
    for (const auto& [num_query, num_match, num_columns] :
         {std::array{1, 1, 32}, {3, 40, 32}, {61, 17, 61}, {130, 200, 64}, {200, 130, 128}, {90, 90, 5}}) {
      for (const double same_spot_px : {0.0, 1.5, 3.0}) {
        const Features match = crowded_features(random, num_match, num_columns, of_bits);
        Features query = crowded_features(random, num_query, num_columns, of_bits);
        make_alike(random, match, query);
        const MatchingOptions options{.max_ratio = 0.97, .same_spot_px = same_spot_px};
        expect_same_bytes(match_features(query, match, options), matches_by_definition(query, match, options));
      }
    }
  }
}

TEST(Matching, OneSpotOfManyFeaturesHasNoSecond) {
  Features query, match;
  query.keypoints = {{10, 10, 3}};
  query.descriptors = cv::Mat1f(1, 4, 0.0F);
  match.descriptors = cv::Mat1f(40, 4, 1.0F);
  for (int i = 0; i < 40; ++i) match.keypoints.emplace_back(50.0F, 50.0F, 3.0F);
  const auto matches = match_features(query, match);
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_EQ(matches[0].ratio, 0.0F);
}

TEST(Matching, FindsEveryTruePair) {
  const auto world = make_two_views({.num_points = 300});
  const auto matches = match_features(world.query.features, world.match.features, {.same_spot_px = 0});
  ASSERT_EQ(matches.size(), 300u);
  for (const Match& match : matches) EXPECT_EQ(match.query, match.match);
}

TEST(Matching, IsMutual) {
  // Two query features look like the one match feature: only the nearer may have it.
  Features query, match;
  query.keypoints = {{10, 10, 3}, {200, 200, 3}};
  query.descriptors = (cv::Mat1f(2, 2) << 1.0F, 0.0F, 0.9F, 0.1F);
  match.keypoints = {{10, 10, 3}, {300, 300, 3}};
  match.descriptors = (cv::Mat1f(2, 2) << 1.0F, 0.0F, -5.0F, 3.0F);
  const auto matches = match_features(query, match);
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_EQ(matches[0].query, 0);
}

TEST(Matching, RefusesWhatLooksLikeTwoPlaces) {
  Features query, match;
  query.keypoints = {{10, 10, 3}};
  query.descriptors = (cv::Mat1f(1, 2) << 0.0F, 0.0F);
  match.keypoints = {{10, 10, 3}, {300, 300, 3}};
  match.descriptors = (cv::Mat1f(2, 2) << 1.0F, 0.0F, 0.0F, 1.05F);
  EXPECT_TRUE(match_features(query, match).empty());
  match.keypoints[1] = {11, 10, 3};  // the second best is the same spot seen with another orientation
  EXPECT_EQ(match_features(query, match).size(), 1u);
}

TEST(Matching, CountsASpotOnce) {
  Features query, match;
  query.keypoints = {{10, 10, 3}, {10, 10, 3}};
  query.descriptors = (cv::Mat1f(2, 2) << 1.0F, 0.0F, 0.0F, 1.0F);
  match.keypoints = {{50, 50, 3}, {50, 50, 3}};
  match.descriptors = query.descriptors.clone();
  EXPECT_EQ(match_features(query, match).size(), 1u);
  EXPECT_EQ(match_features(query, match, {.same_spot_px = 0}).size(), 2u);
}

TEST(Matching, SpotsOfAShrunkImageAreAsWideAsItsPixels) {
  std::mt19937 random(11);
  const Features match = crowded_features(random, 150, 8, false);
  Features query = crowded_features(random, 170, 8, false);
  make_alike(random, match, query);
  for (const MatchSearch search : {MatchSearch::Exact, MatchSearch::Approximate}) {
    const MatchingOptions options{.max_ratio = 0.97, .search = search};
    const auto small = match_features(query, match, options);
    const auto shrunk = match_features(testing_support::enlarged(query, 4), testing_support::enlarged(match, 4), options);
    expect_same_bytes(shrunk, small);
    Features not_shrunk = testing_support::enlarged(query, 4);
    not_shrunk.pixel_size = 1;
    EXPECT_GT(match_features(not_shrunk, match, options).size(), small.size());
  }
}

TEST(Matching, ComparesBitsByHammingDistance) {
  Features query, match;
  query.descriptor_kind = match.descriptor_kind = DescriptorKind::Orb;
  query.keypoints = {{10, 10, 3}};
  query.descriptors = (cv::Mat1b(1, 2) << 0b11110000, 0b00000000);
  match.keypoints = {{10, 10, 3}, {300, 300, 3}};
  match.descriptors = (cv::Mat1b(2, 2) << 0b00001111, 0b11111111, 0b11110001, 0b00000000);
  const auto matches = match_features(query, match);
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_EQ(matches[0].match, 1);
  EXPECT_FLOAT_EQ(matches[0].ratio, 1.0F / 16.0F);
}

/// Descriptors that vary in a few directions most, as real ones do; the query's first are those of the match with noise.
TwoFeatures features_with_structure(int count, int num_true) {
  constexpr int kDirections = 12, kDimension = 128;
  cv::RNG random(5);
  cv::Mat1f directions(kDirections, kDimension), along(count, kDirections), rest(count, kDimension), noise(num_true, kDimension);
  random.fill(directions, cv::RNG::NORMAL, 0.0, 1.0);
  TwoFeatures pair;
  for (Features* features : {&pair.query, &pair.match}) {
    random.fill(along, cv::RNG::NORMAL, 0.0, 1.0);
    random.fill(rest, cv::RNG::NORMAL, 0.0, 0.5);
    features->descriptors = along * directions + rest;
    for (int i = 0; i < count; ++i) {
      features->keypoints.emplace_back(random.uniform(0.0F, 1000.0F), random.uniform(0.0F, 1000.0F), 3.0F);
    }
  }
  random.fill(noise, cv::RNG::NORMAL, 0.0, 0.4);
  cv::Mat(pair.match.descriptors.rowRange(0, num_true) + noise).copyTo(pair.query.descriptors.rowRange(0, num_true));
  return pair;
}

TEST(Matching, ApproximatelyFindsWhatItFindsExactly) {
  const TwoFeatures pair = features_with_structure(1500, 700);
  const auto exact = match_features(pair.query, pair.match);
  const auto approximate = match_features(pair.query, pair.match, {.search = MatchSearch::Approximate});
  ASSERT_GT(exact.size(), 500u);
  const auto num_same = std::count_if(exact.begin(), exact.end(), [&](const Match& match) {
    return std::any_of(approximate.begin(), approximate.end(),
                       [&](const Match& other) { return other.query == match.query && other.match == match.match; });
  });
  EXPECT_GE(static_cast<double>(num_same), 0.95 * static_cast<double>(exact.size()));
  EXPECT_LE(static_cast<double>(approximate.size()), 1.05 * static_cast<double>(exact.size()));
}

TEST(Matching, ApproximatelyKeepsToTheRules) {
  Features query, match;
  query.keypoints = {{10, 10, 3}, {10, 10, 3}};
  query.descriptors = (cv::Mat1f(2, 2) << 1.0F, 0.0F, 0.9F, 0.1F);
  match.keypoints = {{50, 50, 3}, {51, 50, 3}, {300, 300, 3}};
  match.descriptors = (cv::Mat1f(3, 2) << 1.0F, 0.1F, 1.0F, 0.2F, 5.0F, 0.0F);
  const MatchingOptions options{.search = MatchSearch::Approximate};
  const auto found = match_features(query, match, options), exact = match_features(query, match);
  ASSERT_EQ(found.size(), 1u) << "the second best shows the same spot";
  ASSERT_EQ(exact.size(), 1u);
  EXPECT_EQ(found[0].query, exact[0].query);
  EXPECT_EQ(found[0].match, exact[0].match);
  EXPECT_NEAR(found[0].ratio, exact[0].ratio, 1e-4);  // from differences here, from norms and products there
  EXPECT_TRUE(match_features({}, {}, options).empty());
}

TEST(Matching, NothingMatchesNothing) { EXPECT_TRUE(match_features({}, {}).empty()); }

}  // namespace
}  // namespace fabloop
