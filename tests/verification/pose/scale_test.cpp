// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/scale.h"

#include <gtest/gtest.h>

#include "tests/verification/two_view_world.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViews;

std::vector<Match> matches_of_all(const TwoViews& world) {
  std::vector<Match> matches;
  for (int i = 0; i < static_cast<int>(world.pairs.size()); ++i) matches.push_back({i, i, 0});
  return matches;
}

Pose unit(const Pose& pose) { return {pose.rotation, pose.translation.normalized()}; }

TEST(Scale, IsTheBaselineWhereDepthsAreRight) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TwoViews world = make_two_views({.baseline = 1.0 + 0.1 * static_cast<double>(seed), .with_points = true, .seed = seed});
    const auto scale = estimate_scale(world.query, world.match, matches_of_all(world), unit(world.match_from_query));
    ASSERT_TRUE(scale.has_value());
    EXPECT_TRUE(scale->agrees);
    EXPECT_NEAR(scale->baseline, world.match_from_query.translation.norm(), 1e-3);
    EXPECT_NEAR(scale->share, 1.0, 1e-12);
  }
}

TEST(Scale, ErrorsOfSinglePointsAverageOut) {
  const TwoViews world = make_two_views({.noise_px = 0.3, .with_points = true, .depth_noise = 0.1});
  const auto scale = estimate_scale(world.query, world.match, matches_of_all(world), unit(world.match_from_query));
  ASSERT_TRUE(scale && scale->agrees);
  EXPECT_NEAR(scale->baseline, 2.0, 3 * scale->relative_sigma * 2.0);
  EXPECT_LT(scale->relative_sigma, 0.03);
}

TEST(Scale, IsTheSameFromEitherSide) {
  TwoViews world = make_two_views({.with_points = true});
  const Pose query_from_match = world.match_from_query.inverse();
  for (std::size_t i = 0; i < world.pairs.size(); ++i) {
    world.query.points_in_camera[i] = query_from_match * *world.match.points_in_camera[i];
  }
  world.match.points_in_camera.assign(world.pairs.size(), std::nullopt);
  const auto scale = estimate_scale(world.query, world.match, matches_of_all(world), unit(world.match_from_query));
  ASSERT_TRUE(scale && scale->agrees);
  EXPECT_NEAR(scale->baseline, 2.0, 1e-3);
}

TEST(Scale, DepthsAtRandomTellNone) {
  TwoViews world = make_two_views({.with_points = true});
  for (std::size_t i = 0; i < world.pairs.size(); ++i)
    *world.match.points_in_camera[i] *= 0.2 + 0.1 * static_cast<double>(i % 60);
  const auto scale = estimate_scale(world.query, world.match, matches_of_all(world), unit(world.match_from_query));
  ASSERT_TRUE(scale.has_value());
  EXPECT_FALSE(scale->agrees);
}

TEST(Scale, FewPointsTellNone) {
  TwoViews world = make_two_views({.with_points = true});
  for (std::size_t i = 5; i < world.pairs.size(); ++i) world.match.points_in_camera[i].reset();
  EXPECT_FALSE(estimate_scale(world.query, world.match, matches_of_all(world), unit(world.match_from_query)).has_value());
}

TEST(Scale, TheRightPoseIsLikelierThanAWrongOne) {
  const TwoViews world = make_two_views({.with_points = true, .depth_noise = 0.03});
  Pose wrong = unit(world.match_from_query);
  wrong.rotation = wrong.rotation * rotation_from_vector(Eigen::Vector3d(0.1, 0, 0));
  const auto right = estimate_scale(world.query, world.match, matches_of_all(world), unit(world.match_from_query));
  const auto other = estimate_scale(world.query, world.match, matches_of_all(world), wrong);
  ASSERT_TRUE(right.has_value());
  EXPECT_GT(right->log_likelihood, other ? other->log_likelihood : 0.0);
}

}  // namespace
}  // namespace fabloop
