// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

namespace fabloop {

/// What speaks for and against a loop, from three independent sources.
struct LoopEvidence {
  /// Probability of the place by appearance alone: a hypothesis's posterior. One half says nothing.
  double p_appearance = 0.5;
  double log10_false_alarms = 0;  ///< Of the inliers; see evidence.h.
  /// Squared Mahalanobis distance of the pose from the odometry's, and its degrees of freedom; none without a prior.
  std::optional<double> squared_distance = {};
  int degrees_of_freedom = 6;
};

/// Probability that the two views show one place and that the pose is right. The odds of appearance times two factors: the
/// inliers', log-linear in the number of false alarms, fitted on one real flight and checked on two others (see the README of
/// this folder); and the prior's, prior_log_likelihood() of how much further off the pose is than its degrees of freedom explain.
/// Agreement with a prior is no proof, so it never raises the odds.
double loop_probability(const LoopEvidence& evidence);

}  // namespace fabloop
