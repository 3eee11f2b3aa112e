// SPDX-License-Identifier: BSD-3-Clause
#include "verification/rig/rig_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frontend/error.h"
#include "tests/verification/pose_error.h"
#include "tests/verification/rig_world.h"

namespace fabloop {
namespace {

using testing_support::absolute_error;
using testing_support::make_rig_world;
using testing_support::relative_error;
using testing_support::RigWorld;
using testing_support::RigWorldOptions;

constexpr double kNoiseRad = 0.001;  // half a pixel of 500 px of focal length
constexpr double kMaxErrorRad = 3 * kNoiseRad;
// Rounding over a well-posed problem of metres, by a minimiser that stops at a relative decrease of 1e-9.
constexpr double kExact = 1e-6;
// The sum of 1000 chi-squares of 6 degrees has the standard deviation sqrt(2 * 6 * 1000); 3.3 of them leave one in 1000.
constexpr int kNeesTrials = 1000;
const double kNeesMargin = 3.3 * std::sqrt(12.0 / kNeesTrials);

std::vector<RigRayPair> swapped(std::vector<RigRayPair> pairs) {
  for (RigRayPair& pair : pairs) std::swap(pair.query, pair.match);
  return pairs;
}

TEST(RigRelativePose, IsExactAndMetricOnNoiselessData) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const RigWorld world = make_rig_world({.num_data = 60, .rotation_rad = 0.02 * static_cast<double>(seed % 50), .seed = seed});
    const auto found = estimate_rig_relative_pose(world.pairs, {.seed = seed});
    ASSERT_TRUE(found.has_value()) << "seed " << seed;
    EXPECT_LT(relative_error(world.match_from_query, found->match_from_query).norm(), kExact) << "seed " << seed;
    EXPECT_EQ(found->inliers.size(), world.pairs.size()) << "seed " << seed;
    EXPECT_TRUE(found->has_scale) << "seed " << seed;
    EXPECT_EQ(found->solver, RigSolver::FivePlusOne) << "seed " << seed;
  }
}

TEST(RigRelativePose, SwappingTheSidesInvertsIt) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RigWorld world = make_rig_world({.outlier_ratio = 0.2, .noise_rad = kNoiseRad, .seed = seed});
    const auto found = estimate_rig_relative_pose(world.pairs, {.max_error_rad = kMaxErrorRad, .seed = seed});
    const auto inverse = estimate_rig_relative_pose(swapped(world.pairs), {.max_error_rad = kMaxErrorRad, .seed = seed});
    ASSERT_TRUE(found && inverse);
    EXPECT_EQ(found->inliers, inverse->inliers) << "seed " << seed;
    // Of some millimetres of standard deviation.
    EXPECT_LT(relative_error(found->match_from_query, inverse->match_from_query.inverse()).norm(), 1e-5) << "seed " << seed;
  }
}

TEST(RigRelativePose, ResistsFiftyPercentOutliers) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const RigWorld world = make_rig_world({.outlier_ratio = 0.5, .noise_rad = kNoiseRad, .seed = seed});
    const auto found = estimate_rig_relative_pose(world.pairs, {.max_error_rad = kMaxErrorRad, .seed = seed});
    ASSERT_TRUE(found.has_value()) << "seed " << seed;
    const auto error = relative_error(world.match_from_query, found->match_from_query);
    EXPECT_LT(error.head<3>().norm(), 0.05 * world.match_from_query.translation.norm()) << "seed " << seed;
    EXPECT_LT(error.tail<3>().norm(), rad_from_deg(1)) << "seed " << seed;
  }
}

TEST(RigRelativePose, SolversAgreeWhereAllCanSolve) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RigWorld world = make_rig_world({.noise_rad = kNoiseRad, .seed = seed});
    // A threshold beyond all of the noise, so that all have the same inliers.
    RigRelativePoseOptions options{.max_error_rad = 8 * kNoiseRad, .seed = seed};
    const auto automatic = estimate_rig_relative_pose(world.pairs, options);
    ASSERT_TRUE(automatic.has_value());
    for (const RigSolver solver : {RigSolver::FivePlusOne, RigSolver::GeneralisedEigen, RigSolver::SeventeenPoint}) {
      options.solver = solver;
      const auto found = estimate_rig_relative_pose(world.pairs, options);
      ASSERT_TRUE(found.has_value());
      EXPECT_EQ(found->solver, solver);
      EXPECT_LT(relative_error(automatic->match_from_query, found->match_from_query).norm(), 1e-5) << "seed " << seed;
    }
  }
}

TEST(RigRelativePose, NeedsNoTwoRaysOfOneCamera) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RigWorld world = make_rig_world({.seed = seed});
    for (std::size_t i = 0; i < world.pairs.size(); ++i) {  // slide every origin along its ray
      RigRay& ray = world.pairs[i].query;
      ray.origin_in_body += (0.1 + 0.001 * static_cast<double>(i)) * ray.ray_in_body;
    }
    const auto found = estimate_rig_relative_pose(world.pairs, {.seed = seed});
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->solver, RigSolver::GeneralisedEigen);
    EXPECT_LT(relative_error(world.match_from_query, found->match_from_query).norm(), kExact) << "seed " << seed;
    EXPECT_FALSE(estimate_rig_relative_pose(world.pairs, {.solver = RigSolver::FivePlusOne}).has_value());
  }
}

/// Without scale: the direction is right, the length is not claimed.
void expect_direction_only(const RigWorldOptions& options) {
  const RigWorld world = make_rig_world(options);
  const auto found = estimate_rig_relative_pose(world.pairs, {.max_error_rad = kMaxErrorRad, .seed = options.seed});
  ASSERT_TRUE(found.has_value()) << "seed " << options.seed;
  EXPECT_FALSE(found->has_scale) << "seed " << options.seed << ", scale sigma " << found->scale_sigma;
  EXPECT_GT(found->inliers.size(), world.pairs.size() / 2);
  EXPECT_LT(angle_between(found->match_from_query.translation, world.match_from_query.translation), rad_from_deg(3));
  EXPECT_LT(found->match_from_query.rotation.angularDistance(world.match_from_query.rotation), rad_from_deg(1));
}

TEST(RigRelativePose, OneCameraTellsNoScale) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    expect_direction_only({.num_cameras = 1, .ring_radius = 0, .noise_rad = kNoiseRad, .seed = seed});
  }
}

TEST(RigRelativePose, CamerasThatShareNothingTellNoScaleWithoutATurn) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    expect_direction_only(
        {.rotation_rad = 0, .within_cameras = true, .outlier_ratio = 0.2, .noise_rad = kNoiseRad, .seed = seed});
  }
}

TEST(RigRelativePose, ARigTooSmallForTheSceneTellsNoScale) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    expect_direction_only({.ring_radius = 0.002, .outlier_ratio = 0.2, .noise_rad = kNoiseRad, .seed = seed});
  }
}

TEST(RigRelativePose, ATurnTellsTheScaleEvenWhereCamerasShareNothing) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RigWorld world = make_rig_world({.within_cameras = true, .noise_rad = kNoiseRad, .seed = seed});
    const auto found = estimate_rig_relative_pose(world.pairs, {.max_error_rad = kMaxErrorRad, .seed = seed});
    ASSERT_TRUE(found.has_value());
    EXPECT_TRUE(found->has_scale) << "seed " << seed;
    const double error = relative_error(world.match_from_query, found->match_from_query).head<3>().norm();
    const double baseline = world.match_from_query.translation.norm();
    EXPECT_LT(error / baseline, 4 * found->scale_sigma) << "seed " << seed;
  }
}

TEST(RigRelativePose, ErrorsAreWithinChiSquareBounds) {
  double sum = 0;
  for (std::uint64_t seed = 1; seed <= kNeesTrials; ++seed) {
    const RigWorld world = make_rig_world({.num_data = 60, .noise_rad = kNoiseRad, .seed = seed});
    const auto found =
        estimate_rig_relative_pose(world.pairs, {.max_error_rad = kMaxErrorRad, .max_iterations = 8, .seed = seed});
    ASSERT_TRUE(found.has_value()) << "seed " << seed;
    const auto error = relative_error(world.match_from_query, found->match_from_query);
    sum += error.dot(found->information * error);
  }
  // 54 degrees of freedom for the noise's variance.
  EXPECT_NEAR(sum / kNeesTrials, 6 * 54.0 / 52.0, kNeesMargin);
}

TEST(RigRelativePose, FewPairsHaveNone) {
  const RigWorld world = make_rig_world({.num_data = 6});
  EXPECT_FALSE(estimate_rig_relative_pose(world.pairs).has_value());
  EXPECT_FALSE(estimate_rig_relative_pose({}).has_value());
}

TEST(RigRelativePose, RefusesWhatIsNoNumber) {
  RigWorld world = make_rig_world({});
  EXPECT_THROW(estimate_rig_relative_pose(world.pairs, {.max_error_rad = 0}), InputError);
  world.pairs[3].match.origin_in_body.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(estimate_rig_relative_pose(world.pairs), InputError);
}

TEST(RigAbsolutePose, IsExactOnNoiselessData) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const RigWorld world = make_rig_world(
        {.num_data = 30, .num_cameras = 1 + seed % 5, .rotation_rad = 0.01 * static_cast<double>(seed % 50), .seed = seed});
    const auto found = estimate_rig_absolute_pose(world.points_and_rays, {.seed = seed});
    ASSERT_TRUE(found.has_value()) << "seed " << seed;
    EXPECT_LT(absolute_error(world.match_from_query, found->world_from_body).norm(), kExact) << "seed " << seed;
    EXPECT_EQ(found->inliers.size(), world.points_and_rays.size()) << "seed " << seed;
  }
}

TEST(RigAbsolutePose, ResistsFiftyPercentOutliers) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const RigWorld world = make_rig_world({.outlier_ratio = 0.5, .noise_rad = kNoiseRad, .seed = seed});
    const auto found = estimate_rig_absolute_pose(world.points_and_rays, {.max_error_rad = kMaxErrorRad, .seed = seed});
    ASSERT_TRUE(found.has_value()) << "seed " << seed;
    const auto error = absolute_error(world.match_from_query, found->world_from_body);
    EXPECT_LT(error.head<3>().norm(), 0.02) << "seed " << seed;
    EXPECT_LT(error.tail<3>().norm(), rad_from_deg(0.3)) << "seed " << seed;
  }
}

TEST(RigAbsolutePose, ErrorsAreWithinChiSquareBounds) {
  double sum = 0;
  for (std::uint64_t seed = 1; seed <= kNeesTrials; ++seed) {
    const RigWorld world = make_rig_world({.num_data = 40, .noise_rad = kNoiseRad, .seed = seed});
    const auto found = estimate_rig_absolute_pose(world.points_and_rays, {.max_error_rad = kMaxErrorRad, .seed = seed});
    ASSERT_TRUE(found.has_value()) << "seed " << seed;
    const auto error = absolute_error(world.match_from_query, found->world_from_body);
    sum += error.dot(found->information * error);
  }
  // 74 degrees of freedom for the noise's variance.
  EXPECT_NEAR(sum / kNeesTrials, 6 * 74.0 / 72.0, kNeesMargin);
}

TEST(RigAbsolutePose, FewDataOrNoNumbersHaveNone) {
  RigWorld world = make_rig_world({.num_data = 4});
  EXPECT_FALSE(estimate_rig_absolute_pose(world.points_and_rays).has_value());
  EXPECT_THROW(estimate_rig_absolute_pose(world.points_and_rays, {.max_error_rad = -1}), InputError);
  world.points_and_rays[0].point_in_world.x() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(estimate_rig_absolute_pose(world.points_and_rays), InputError);
}

}  // namespace
}  // namespace fabloop
