// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "verification/absolute_pose.h"
#include "verification/relative_pose.h"

namespace fabloop {

/// How well a relative pose is known, as a pose-graph edge states it: information (inverse covariance) of (translation,
/// rotation) of match_from_query, both in the query's axes. What the inliers' scatter shows is widened by what it cannot show:
/// lens calibration, moving shutters, points that share one baseline's error.
struct EdgeInformation {
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  double rotation_sigma_rad = 0;  ///< Largest, from the inliers' scatter alone.
  double translation_sigma = 0;   ///< Largest, from the scatter alone: metres, or radians of a direction.
};

/// Of a metric pose among points at `median_depth` (metres) whose unit of length is known to `scale_sigma` (relative).
EdgeInformation metric_edge_information(const Pose& match_from_query, const Eigen::Matrix<double, 6, 6>& covariance,
                                        double median_depth, double scale_sigma);

/// Of a rotation and a direction: no information along the direction.
EdgeInformation direction_edge_information(const RelativePose& relative);

/// Covariance of (translation, rotation) in the camera's axes of an absolute pose, from its inliers' scatter alone.
Eigen::Matrix<double, 6, 6> covariance_in_camera(const AbsolutePose& pose);

/// Covariance of the inverse pose, likewise in its own camera's axes.
Eigen::Matrix<double, 6, 6> covariance_of_inverse(const Pose& a_from_b, const Eigen::Matrix<double, 6, 6>& covariance);

}  // namespace fabloop
