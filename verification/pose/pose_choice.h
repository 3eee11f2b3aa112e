// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/matching/matching.h"
#include "verification/pose/plane_scale.h"
#include "verification/pose/relative_pose.h"
#include "verification/pose/scale.h"
#include "verification/view.h"

namespace fabloop {

/// What is known of a relative pose before the images are compared: odometry, the map so far, GPS.
struct PosePrior {
  Pose match_from_query;
  /// Of (translation, rotation), both in the query's axes, in the unit of the points; positive definite.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Identity();
};

struct PoseChoiceOptions {
  RelativePoseOptions pose;
  ScaleOptions scale;             ///< By points.
  PlaneScaleOptions plane_scale;  ///< By heights, where points do not tell it, or in a vaguer unit.
};

/// One of the poses that explain a pair of views.
struct PoseCandidate {
  RelativePose relative;
  std::optional<Scale> scale;  ///< What the points say of it, or the heights.
  double unit_sigma = 0;       ///< Of the points' unit of length: View::unit_sigma.
  /// Of each pair, those set aside last: by how much, in logarithms, it is likelier about this pose than at random within the
  /// threshold; 0 beyond it.
  std::vector<double> pair_scores;
  double other_score = 0;  ///< The same of the points and of the prior.
};

/// The poses that explain a pair of views.
struct PoseChoice {
  PoseCandidate chosen;
  /// By how much, in logarithms of likelihood, the chosen one leads the next; none where it is the only one.
  std::optional<double> lead;
};

/// Below this lead nothing tells the two poses of a plane apart.
inline constexpr double kMinLead = 5.0;

/// The relative pose or one that a plane would explain as well: the likelier one, by its rays, the points and the prior. By luck,
/// and by errors of the lens that near pairs share, rays lie closer on one of two poses that explain them alike: what counts is
/// by how much more than three standard deviations of luck. `set_aside` are pairs that no pose is refined on, but that count for
/// those with which they agree.
PoseChoice choose_pose(const View& query, const View& match, const std::vector<Match>& matches, std::span<const RayPair> pairs,
                       RelativePose relative, const PoseChoiceOptions& options, const std::optional<PosePrior>& prior,
                       std::span<const RayPair> set_aside = {});

/// Squared Mahalanobis distance of a pose from a prior.
double squared_distance(const Pose& match_from_query, const PosePrior& prior);

/// Logarithm of the density of a pose at that distance from a prior, over the density at the prior: Student's t with four
/// degrees of freedom, since odometry now and then errs by more than it says.
double prior_log_likelihood(double squared_distance, int degrees_of_freedom);

}  // namespace fabloop
