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
inline constexpr double kMinLead = 10.0;

/// The relative pose and those that a plane would explain as well, most likely first.
std::vector<PoseCandidate> pose_candidates(const View& query, const View& match, const std::vector<Match>& matches,
                                           std::span<const RayPair> pairs, RelativePose relative,
                                           const RelativePoseOptions& pose_options, const ScaleOptions& scale_options,
                                           const std::optional<PosePrior>& prior);

/// Squared Mahalanobis distance of a pose from a prior.
double squared_distance(const Pose& match_from_query, const PosePrior& prior);

/// Logarithm of the density of a pose at that distance from a prior, over the density at the prior: Student's t with four
/// degrees of freedom, since odometry now and then errs by more than it says.
double prior_log_likelihood(double squared_distance, int degrees_of_freedom);

}  // namespace fabloop
