// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/absolute_pose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "frontend/error.h"
#include "tests/verification/absolute_pose_world.h"
#include "tests/verification/pose_error.h"
#include "tests/verification/two_view_world.h"
#include "verification/pose/triangulation.h"

namespace fabloop {
namespace {

using testing_support::absolute_error;
using testing_support::kFocalPx;
using testing_support::make_absolute_pose_world;
using testing_support::make_two_views;
using testing_support::TwoViews;

std::vector<PointRay> points_and_rays(const TwoViews& world) {
  std::vector<PointRay> data;
  for (std::size_t i = 0; i < world.pairs.size(); ++i) data.push_back({*world.match.points_in_camera[i], world.query.rays[i]});
  return data;
}

TEST(AbsolutePose, IsExactOnNoiselessDataInAnyAttitude) {
  // Rounding of 20 m over a pose known from 30 rays, by a minimiser that stops at a relative decrease of 1e-9.
  constexpr double kExactM = 1e-6;
  constexpr double kExactRad = 1e-7;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    const auto world = make_absolute_pose_world({.num_data = 30, .planar = seed % 4 == 0, .seed = seed});
    const auto found = estimate_absolute_pose(world.data, {.seed = seed});
    ASSERT_TRUE(found.has_value()) << "seed " << seed;
    EXPECT_LT((found->world_from_camera.translation - world.world_from_camera.translation).norm(), kExactM) << "seed " << seed;
    EXPECT_LT(found->world_from_camera.rotation.angularDistance(world.world_from_camera.rotation), kExactRad) << "seed " << seed;
    EXPECT_EQ(found->inliers.size(), world.data.size()) << "seed " << seed;
  }
}

TEST(AbsolutePose, FindsThePoseAmongSeventyPercentOutliers) {
  int right = 0;
  constexpr int kTrials = 100;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    const auto world = make_absolute_pose_world({.outlier_ratio = 0.7, .noise_px = 0.5, .seed = seed});
    const auto found =
        estimate_absolute_pose(world.data, {.max_error_rad = 1.5 / kFocalPx, .max_iterations = 5000, .seed = seed});
    if (!found) continue;
    const auto error = absolute_error(world.world_from_camera, found->world_from_camera);
    constexpr double kFivePercentOfTheDepth = 0.05 * 8;
    right += error.head<3>().norm() < kFivePercentOfTheDepth && error.tail<3>().norm() < rad_from_deg(1);
  }
  EXPECT_EQ(right, kTrials);
}

TEST(AbsolutePose, IsTheSameInEveryRun) {
  const auto world = make_absolute_pose_world({.outlier_ratio = 0.5, .noise_px = 0.5});
  const auto once = estimate_absolute_pose(world.data, {.seed = 7});
  const auto again = estimate_absolute_pose(world.data, {.seed = 7});
  ASSERT_TRUE(once && again);
  EXPECT_EQ(once->world_from_camera.translation, again->world_from_camera.translation);
  EXPECT_EQ(once->inliers, again->inliers);
}

TEST(AbsolutePose, MovesWithTheWorld) {
  const Pose new_from_old{rotation_from_vector({0.3, -1.2, 0.7}), {5, -3, 11}};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    auto world = make_absolute_pose_world({.outlier_ratio = 0.2, .noise_px = 0.5, .seed = seed});
    const auto before = estimate_absolute_pose(world.data, {.seed = seed});
    for (PointRay& datum : world.data) datum.point_in_world = new_from_old * datum.point_in_world;
    const auto after = estimate_absolute_pose(world.data, {.seed = seed});
    ASSERT_TRUE(before && after);
    // Both have converged to a relative decrease of 1e-9, which is 3e-5 of a standard deviation of some centimetres.
    EXPECT_LT(absolute_error(new_from_old * before->world_from_camera, after->world_from_camera).norm(), 1e-5) << "seed " << seed;
  }
}

constexpr double kPointNoiseRad = 0.5 / kFocalPx;

/// Mean over 1000 problems of e^T I e for the error e: 6 when the information I is that of the error.
double mean_nees(const AbsolutePoseOptions& options) {
  constexpr int kTrials = 1000;
  double sum = 0;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    const auto world = make_absolute_pose_world({.num_data = 60, .noise_rad = kPointNoiseRad, .seed = seed});
    AbsolutePoseOptions seeded = options;
    seeded.seed = seed;
    const auto found = estimate_absolute_pose(world.data, seeded);
    if (!found) return std::nan("");
    const auto error = absolute_error(world.world_from_camera, found->world_from_camera);
    sum += error.dot(found->information * error);
  }
  return sum / kTrials;
}

// The sum of 1000 chi-squares of 6 degrees has the standard deviation sqrt(2 * 6 * 1000); 3.3 of them leave one in 1000.
const double kPointNeesMargin = 3.3 * std::sqrt(12.0 / 1000.0);

TEST(AbsolutePose, ErrorsAreWithinChiSquareBoundsWhenTheNoiseIsKnown) {
  const double nees = mean_nees({.max_error_rad = 5 * kPointNoiseRad, .noise_rad = kPointNoiseRad});
  EXPECT_NEAR(nees, 6, kPointNeesMargin);
}

TEST(AbsolutePose, ErrorsAreWithinChiSquareBoundsWhenTheNoiseComesFromTheInliers) {
  // 114 degrees of freedom for the variance: the ratio's mean is 6 * 114 / 112. The threshold cuts 4 % of the noise off.
  const double nees = mean_nees({.max_error_rad = 2.5 * kPointNoiseRad});
  EXPECT_NEAR(nees, 6 * 114.0 / 112.0, kPointNeesMargin);
}

TEST(AbsolutePose, IsExactOnTwoViews) {
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

TEST(AbsolutePose, RefusesAThresholdThatIsNone) {
  EXPECT_THROW(estimate_absolute_pose({}, {.max_error_rad = 0}), InputError);
  EXPECT_THROW(estimate_absolute_pose({}, {.max_error_rad = std::nan("")}), InputError);
}

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
