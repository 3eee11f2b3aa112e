// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching.h"

#include <gtest/gtest.h>

#include "tests/verification/two_view_world.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;

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

TEST(Matching, NothingMatchesNothing) { EXPECT_TRUE(match_features({}, {}).empty()); }

}  // namespace
}  // namespace fabloop
