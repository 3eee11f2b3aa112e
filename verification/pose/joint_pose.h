// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/pose/absolute_pose.h"
#include "verification/pose/relative_pose.h"

namespace fabloop {

/// Everything that two views say about their metric relative pose.
struct JointData {
  std::vector<RayPair> pairs;          ///< Rays of both.
  std::vector<PointRay> match_points;  ///< Points in the match's frame, rays of the query.
  std::vector<PointRay> query_points;  ///< Points in the query's frame, rays of the match.
};

struct JointPoseOptions {
  double max_ray_error_rad = 0.004;    ///< Epipolar, for an inlier.
  double max_point_error_rad = 0.008;  ///< Between a point and its ray, for an inlier.
};

struct JointPose {
  Pose match_from_query;
  std::vector<std::size_t> pair_inliers;   ///< Indices into JointData::pairs.
  std::size_t num_point_inliers = 0;       ///< Of both sides together.
  Eigen::Matrix<double, 6, 6> covariance;  ///< Of (translation, rotation) in the query's axes, from the inliers' scatter alone.
  double median_depth = 0;                 ///< Of the point inliers, in the unit of the points.
};

/// Refines a metric pose on rays and points together: the rays know the rotation and the direction best, the points the
/// distance. Each kind is weighed by its own scatter. The pose's tangent is (translation, rotation) in the query's axes.
JointPose refine_joint_pose(const JointData& data, const Pose& match_from_query, const JointPoseOptions& options = {});

}  // namespace fabloop
