// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose_choice.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

#include "verification/planar_ambiguity.h"

namespace fabloop {
namespace {

std::vector<Match> inlier_matches(const std::vector<Match>& matches, const RelativePose& relative) {
  std::vector<Match> inliers;
  for (const std::size_t i : relative.inliers) inliers.push_back(matches[i]);
  return inliers;
}

double log_likelihood(const PoseCandidate& candidate, const std::optional<PosePrior>& prior) {
  double sum = candidate.relative.num_true;
  if (candidate.scale) sum += candidate.scale->log_likelihood;
  if (!prior) return sum;
  Pose pose = candidate.relative.match_from_query;
  pose.translation *= candidate.scale ? candidate.scale->baseline : prior->match_from_query.translation.norm();
  return sum - 0.5 * squared_distance(pose, Eigen::Matrix<double, 6, 6>::Zero(), *prior);
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
    candidate.score = log_likelihood(candidate, prior);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const PoseCandidate& a, const PoseCandidate& b) { return a.score > b.score; });
  return candidates;
}

double squared_distance(const Pose& match_from_query, const Eigen::Matrix<double, 6, 6>& covariance, const PosePrior& prior) {
  const Pose difference = prior.match_from_query.inverse() * match_from_query;
  const Eigen::AngleAxisd turn(difference.rotation);
  Eigen::Matrix<double, 6, 1> error;
  error << difference.translation, turn.angle() * turn.axis();
  const Eigen::Matrix<double, 6, 6> sum = covariance + prior.covariance;
  return error.dot(sum.ldlt().solve(error));
}

}  // namespace fabloop
