// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/relative_pose.h"

#include <gtest/gtest.h>

#include "tests/verification/two_view_world.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViews;

double rotation_error_deg(const Pose& a, const Pose& b) { return deg_from_rad(a.rotation.angularDistance(b.rotation)); }
double direction_error_deg(const Pose& a, const Pose& b) { return deg_from_rad(angle_between(a.translation, b.translation)); }

/// Keypoints are stored as floats, which is 3e-5 px at 640 px.
constexpr double kExactDeg = 1e-4;

TEST(RelativePose, IsExactOnNoiselessData) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TwoViews world = make_two_views({.num_points = 100, .seed = seed});
    const auto found = estimate_relative_pose(world.pairs, {.seed = seed});
    ASSERT_TRUE(found.has_value()) << "seed " << seed;
    EXPECT_LT(rotation_error_deg(found->match_from_query, world.match_from_query), kExactDeg) << "seed " << seed;
    EXPECT_LT(direction_error_deg(found->match_from_query, world.match_from_query), 10 * kExactDeg) << "seed " << seed;
    EXPECT_EQ(found->inliers.size(), world.pairs.size());
    EXPECT_NEAR(found->match_from_query.translation.norm(), 1.0, 1e-12);
  }
}

TEST(RelativePose, ResistsHalfOutliers) {
  int right = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const TwoViews world = make_two_views({.outlier_ratio = 0.5, .noise_px = 0.5, .seed = seed});
    const auto found = estimate_relative_pose(world.pairs, {.max_error_rad = 1.5 / 500, .seed = seed});
    right += found && rotation_error_deg(found->match_from_query, world.match_from_query) < 1 &&
             direction_error_deg(found->match_from_query, world.match_from_query) < 5;
  }
  EXPECT_GE(right, 49);
}

TEST(RelativePose, SwappingTheViewsInvertsThePose) {
  const TwoViews world = make_two_views({.seed = 7});
  std::vector<RayPair> swapped;
  for (const auto& [query, match] : world.pairs) swapped.push_back({match, query});
  const auto forward = estimate_relative_pose(world.pairs);
  const auto backward = estimate_relative_pose(swapped);
  ASSERT_TRUE(forward && backward);
  const Pose inverse = backward->match_from_query.inverse();
  EXPECT_LT(rotation_error_deg(forward->match_from_query, inverse), kExactDeg);
  EXPECT_LT(direction_error_deg(forward->match_from_query, inverse), 10 * kExactDeg);
}

TEST(RelativePose, IsTheSameForTheSameSeed) {
  const TwoViews world = make_two_views({.outlier_ratio = 0.4, .noise_px = 1, .seed = 3});
  const auto a = estimate_relative_pose(world.pairs, {.seed = 5});
  const auto b = estimate_relative_pose(world.pairs, {.seed = 5});
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->match_from_query.translation, b->match_from_query.translation);
  EXPECT_EQ(a->inliers, b->inliers);
}

TEST(RelativePose, TooFewPairsHaveNoPose) {
  const TwoViews world = make_two_views({.num_points = 5});
  EXPECT_FALSE(estimate_relative_pose(world.pairs).has_value());
  EXPECT_FALSE(estimate_relative_pose({}).has_value());
}

TEST(RelativePose, InformationPredictsTheScatter) {
  // Mean squared rotation error against what the information says, over many draws of the noise.
  double squared_error = 0;
  double predicted = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const TwoViews world = make_two_views({.noise_px = 1, .seed = seed});
    const auto found = refine_relative_pose(world.pairs, world.match_from_query, {.max_error_rad = 0.02});
    ASSERT_TRUE(found.has_value());
    const double error = found->match_from_query.rotation.angularDistance(world.match_from_query.rotation);
    squared_error += error * error;
    predicted += found->information.inverse().topLeftCorner<3, 3>().trace();
  }
  // 50 draws of three degrees of freedom scatter by about 12 %; a factor of 1.5 is far outside.
  EXPECT_LT(squared_error / predicted, 1.5);
  EXPECT_GT(squared_error / predicted, 1 / 1.5);
}

TEST(RelativePose, ParallaxIsZeroForAPureRotation) {
  const TwoViews world = make_two_views({.baseline = 1e-9, .seed = 2});
  std::vector<std::size_t> all(world.pairs.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  EXPECT_LT(deg_from_rad(median_parallax(world.pairs, all, world.match_from_query)), 1e-4);
}

}  // namespace
}  // namespace fabloop
