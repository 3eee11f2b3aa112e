// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/joint_pose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/two_view_world.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViewOptions;
using testing_support::TwoViews;

/// Rays of both views and the points of the match.
JointData joint_data(const TwoViews& world) {
  JointData data;
  data.pairs = world.pairs;
  for (std::size_t i = 0; i < world.pairs.size(); ++i)
    data.match_points.push_back({*world.match.points_in_camera[i], world.pairs[i].query});
  return data;
}

/// The same points as the query would know them.
JointData with_points_of_query(const TwoViews& world) {
  JointData data = joint_data(world);
  const Pose query_from_match = world.match_from_query.inverse();
  for (std::size_t i = 0; i < data.pairs.size(); ++i) {
    data.query_points.push_back({query_from_match * data.match_points[i].point_in_world, data.pairs[i].match});
  }
  data.match_points.clear();
  return data;
}

Pose perturbed(const Pose& pose) {
  return {pose.rotation * rotation_from_vector({0.002, -0.001, 0.0015}), pose.translation + Eigen::Vector3d(0.02, -0.02, 0.01)};
}

double rotation_error(const Pose& a, const Pose& b) { return a.rotation.angularDistance(b.rotation); }

/// (translation, rotation) from the truth to the estimate, in the query's axes, as the covariance has it.
Eigen::Matrix<double, 6, 1> error_in_query(const Pose& truth, const Pose& found) {
  const Pose difference = truth.inverse() * found;
  const Eigen::AngleAxisd rotation(difference.rotation);
  Eigen::Matrix<double, 6, 1> error;
  error << difference.translation, rotation.angle() * rotation.axis();
  return error;
}

/// Keypoints are floats: 3e-5 px over 500 px, at 14 m.
constexpr double kExactRad = 1e-6;
constexpr double kExactM = 1e-5;

TEST(JointPose, IsExactOnNoiselessDataFromAPerturbedStart) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const TwoViews world = make_two_views({.with_points = true, .seed = seed});
    for (const JointData& data : {joint_data(world), with_points_of_query(world)}) {
      const JointPose found = refine_joint_pose(data, perturbed(world.match_from_query));
      EXPECT_LT(rotation_error(found.match_from_query, world.match_from_query), kExactRad) << seed;
      EXPECT_LT((found.match_from_query.translation - world.match_from_query.translation).norm(), kExactM) << seed;
      EXPECT_EQ(found.pair_inliers.size(), data.pairs.size());
      EXPECT_EQ(found.num_point_inliers, data.pairs.size());
    }
  }
}

TEST(JointPose, KnowsItsRotationBetterThanPointsAlone) {
  double squared_joint = 0, squared_points = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const TwoViews world =
        make_two_views({.num_points = 80, .noise_px = 0.5, .with_points = true, .depth_noise = 0.1, .seed = seed});
    const JointPoseOptions options{.max_ray_error_rad = 0.02, .max_point_error_rad = 0.05};
    const JointData joint = joint_data(world);
    JointData points = joint;
    points.pairs.clear();
    squared_joint += std::pow(
        rotation_error(refine_joint_pose(joint, world.match_from_query, options).match_from_query, world.match_from_query), 2);
    squared_points += std::pow(
        rotation_error(refine_joint_pose(points, world.match_from_query, options).match_from_query, world.match_from_query), 2);
  }
  EXPECT_LT(squared_joint, squared_points);
}

TEST(JointPose, TheCovariancePredictsTheScatter) {
  // Exact points, noisy rays: then rays and points say the same pixel twice, so the covariance may be too small by up to the
  // factor two that counting twice makes; 40 draws of three degrees of freedom scatter by another eighth.
  constexpr double kMaxRatio = 2.5;
  constexpr double kMinRatio = 1 / 1.5;
  double translation = 0, rotation = 0, predicted_translation = 0, predicted_rotation = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const TwoViews world = make_two_views({.num_points = 80, .noise_px = 1, .with_points = true, .seed = seed});
    const JointPose found =
        refine_joint_pose(joint_data(world), world.match_from_query, {.max_ray_error_rad = 0.02, .max_point_error_rad = 0.02});
    const auto error = error_in_query(world.match_from_query, found.match_from_query);
    translation += error.head<3>().squaredNorm();
    rotation += error.tail<3>().squaredNorm();
    predicted_translation += found.covariance.topLeftCorner<3, 3>().trace();
    predicted_rotation += found.covariance.bottomRightCorner<3, 3>().trace();
  }
  EXPECT_LT(translation / predicted_translation, kMaxRatio);
  EXPECT_GT(translation / predicted_translation, kMinRatio);
  EXPECT_LT(rotation / predicted_rotation, kMaxRatio);
  EXPECT_GT(rotation / predicted_rotation, kMinRatio);
}

TEST(JointPose, LeavesOutliersOut) {
  const TwoViews world = make_two_views({.outlier_ratio = 0.3, .noise_px = 0.3, .with_points = true});
  const JointPose found = refine_joint_pose(joint_data(world), world.match_from_query);
  EXPECT_LT(found.num_point_inliers, world.pairs.size());
  EXPECT_LT(rotation_error(found.match_from_query, world.match_from_query), rad_from_deg(0.2));
  EXPECT_LT((found.match_from_query.translation - world.match_from_query.translation).norm(), 0.05);
  EXPECT_GT(found.median_depth, 8);
  EXPECT_LT(found.median_depth, 20);
}

}  // namespace
}  // namespace fabloop
