// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose_choice.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "verification/planar_ambiguity.h"

namespace fabloop {
namespace {

std::vector<Match> inlier_matches(const std::vector<Match>& matches, const RelativePose& relative) {
  std::vector<Match> inliers;
  for (const std::size_t i : relative.inliers) inliers.push_back(matches[i]);
  return inliers;
}

/// Of the true pairs, their noise being as large as it turned out, against residuals at random within the threshold: the right
/// one of two poses is often not the one with more inliers, but the one on which they lie closer.
double log_likelihood(const RelativePose& relative, double max_error_rad) {
  constexpr double kMaxSharpness = 20.0;  // a noise below a twentieth of the threshold is luck
  return relative.num_true * std::log(std::min(kMaxSharpness, max_error_rad / relative.noise_rad));
}

double log_likelihood(const PoseCandidate& candidate, double max_error_rad, const std::optional<PosePrior>& prior) {
  double sum = log_likelihood(candidate.relative, max_error_rad);
  if (candidate.scale) sum += candidate.scale->log_likelihood;
  if (!prior) return sum;
  Pose pose = candidate.relative.match_from_query;
  pose.translation *= candidate.scale && candidate.scale->agrees ? candidate.scale->baseline : prior->match_from_query.translation.norm();
  return sum + prior_log_likelihood(squared_distance(pose, *prior), 6);
}

}  // namespace

std::vector<PoseCandidate> pose_candidates(const View& query, const View& match, const std::vector<Match>& matches,
                                           std::span<const RayPair> pairs, RelativePose relative,
                                           const RelativePoseOptions& pose_options, const ScaleOptions& scale_options,
                                           const std::optional<PosePrior>& prior) {
  std::vector<PoseCandidate> candidates;
  PlanarScene scene = planar_scene(pairs, relative, pose_options);
  candidates.push_back({std::move(relative), {}, 0});
  for (RelativePose& rival : scene.rivals) candidates.push_back({std::move(rival), {}, 0});
  for (PoseCandidate& candidate : candidates) {
    candidate.scale = estimate_scale(query, match, inlier_matches(matches, candidate.relative),
                                     candidate.relative.match_from_query, scale_options);
    candidate.score = log_likelihood(candidate, pose_options.max_error_rad, prior);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const PoseCandidate& a, const PoseCandidate& b) { return a.score > b.score; });
  return candidates;
}

double squared_distance(const Pose& match_from_query, const PosePrior& prior) {
  const Pose difference = prior.match_from_query.inverse() * match_from_query;
  const Eigen::AngleAxisd turn(difference.rotation);
  Eigen::Matrix<double, 6, 1> error;
  error << difference.translation, turn.angle() * turn.axis();
  return error.dot(prior.covariance.ldlt().solve(error));
}

double prior_log_likelihood(double squared_distance, int degrees_of_freedom) {
  constexpr double kTail = 4.0;
  return -0.5 * (kTail + degrees_of_freedom) * std::log1p(squared_distance / kTail);
}

}  // namespace fabloop
