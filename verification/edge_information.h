// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "frontend/geometry/pose.h"
#include "verification/pose/relative_pose.h"

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

/// Covariance of (translation, rotation), both in the query's axes, of a relative pose once its translation has a length that is
/// known to `relative_sigma`.
Eigen::Matrix<double, 6, 6> scaled_covariance(const RelativePose& relative, double baseline, double relative_sigma);

/// Of a rotation and a direction: no information along the direction.
EdgeInformation direction_edge_information(const RelativePose& relative);

/// The same edge with the distance given up: information on the unit direction instead, none along it.
Eigen::Matrix<double, 6, 6> without_scale(const Eigen::Matrix<double, 6, 6>& information, const Pose& match_from_query);

}  // namespace fabloop
