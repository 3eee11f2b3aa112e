// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/matching.h"
#include "verification/relative_pose.h"
#include "verification/scale.h"
#include "verification/view.h"

namespace fabloop {

/// What is known of a relative pose before the images are compared: odometry, the map so far, GPS.
struct PosePrior {
  Pose match_from_query;
  /// Of (translation, rotation), both in the query's axes, in the unit of the points; positive definite.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Identity();
};

/// One of the poses that explain a pair of views, with what the points say to it.
struct PoseCandidate {
  RelativePose relative;
  std::optional<Scale> scale;
  double score = 0;  ///< Logarithm of a likelihood, up to a constant: of its true pairs, of the points and of the prior.
};

/// How far, in logarithms, the best candidate must lead: below it nothing tells the two poses of a plane apart.
inline constexpr double kMinLead = 5.0;

/// The relative pose and those that a plane would explain as well, most likely first.
std::vector<PoseCandidate> pose_candidates(const View& query, const View& match, const std::vector<Match>& matches,
                                           std::span<const RayPair> pairs, RelativePose relative,
                                           const RelativePoseOptions& pose_options, const ScaleOptions& scale_options,
                                           const std::optional<PosePrior>& prior);

/// Squared Mahalanobis distance of a pose from a prior: chi-square distributed with 6 degrees of freedom for a right one, 5
/// without scale (then the length of the prior is taken). `covariance` is the pose's own, in the same axes.
double squared_distance(const Pose& match_from_query, const Eigen::Matrix<double, 6, 6>& covariance, const PosePrior& prior);

}  // namespace fabloop
