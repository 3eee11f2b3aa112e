// SPDX-License-Identifier: BSD-3-Clause
#include "verification/absolute_pose.h"

#include <gtest/gtest.h>

#include "tests/verification/two_view_world.h"
#include "verification/triangulation.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViews;

std::vector<PointRay> points_and_rays(const TwoViews& world) {
  std::vector<PointRay> data;
  for (std::size_t i = 0; i < world.pairs.size(); ++i) data.push_back({*world.match.points_in_camera[i], world.query.rays[i]});
  return data;
}

TEST(AbsolutePose, IsExactOnNoiselessData) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TwoViews world = make_two_views({.with_points = true, .seed = seed});
    const auto found = estimate_absolute_pose(points_and_rays(world), {.seed = seed});
    ASSERT_TRUE(found.has_value()) << "seed " << seed;
    EXPECT_LT((found->world_from_camera.translation - world.match_from_query.translation).norm(), 1e-4) << "seed " << seed;
    EXPECT_LT(found->world_from_camera.rotation.angularDistance(world.match_from_query.rotation), 1e-5) << "seed " << seed;
  }
}

TEST(AbsolutePose, ResistsOutliersAndNoise) {
  int right = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TwoViews world = make_two_views({.outlier_ratio = 0.6, .noise_px = 0.5, .with_points = true, .seed = seed});
    const auto found = estimate_absolute_pose(points_and_rays(world), {.max_error_rad = 2.0 / 500, .seed = seed});
    right += found && (found->world_from_camera.translation - world.match_from_query.translation).norm() < 0.1;
  }
  EXPECT_GE(right, 19);
}

TEST(AbsolutePose, InformationPredictsTheScatter) {
  double squared_error = 0;
  double predicted = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const TwoViews world = make_two_views({.noise_px = 1, .with_points = true, .seed = seed});
    // The points are exact, only the query's rays are noisy.
    const auto found = estimate_absolute_pose(points_and_rays(world), {.max_error_rad = 0.02, .seed = seed});
    ASSERT_TRUE(found.has_value());
    squared_error += (found->world_from_camera.translation - world.match_from_query.translation).squaredNorm();
    predicted += found->information.inverse().topLeftCorner<3, 3>().trace();
  }
  EXPECT_LT(squared_error / predicted, 1.5);
  EXPECT_GT(squared_error / predicted, 1 / 1.5);
}

TEST(AbsolutePose, TooFewPointsHaveNoPose) { EXPECT_FALSE(estimate_absolute_pose({}).has_value()); }

TEST(Triangulation, FindsThePointBothRaysSee) {
  const TwoViews world = make_two_views({.with_points = true, .seed = 4});
  for (std::size_t i = 0; i < world.pairs.size(); ++i) {
    const auto x_in_match = triangulate(world.pairs[i].match, world.pairs[i].query, world.match_from_query);
    ASSERT_TRUE(x_in_match.has_value());
    EXPECT_LT((*x_in_match - *world.match.points_in_camera[i]).norm(), 1e-3);
  }
}

TEST(Triangulation, RefusesParallelRaysAndPointsBehind) {
  const Pose a_from_b{Eigen::Quaterniond::Identity(), {1, 0, 0}};
  EXPECT_FALSE(triangulate({0, 0, 1}, {0, 0, 1}, a_from_b).has_value());
  const Eigen::Vector3d towards_left = Eigen::Vector3d(-0.3, 0, 1).normalized();
  EXPECT_TRUE(triangulate({0, 0, 1}, towards_left, a_from_b).has_value());
  EXPECT_FALSE(triangulate(towards_left, {0, 0, 1}, a_from_b).has_value());
}

}  // namespace
}  // namespace fabloop
