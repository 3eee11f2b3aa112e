// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/pose_choice.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "verification/pose/epipolar_refinement.h"
#include "verification/pose/inlier_noise.h"
#include "verification/pose/planar_ambiguity.h"
#include "verification/uncertain_pose.h"

namespace fabloop {
namespace {

std::vector<Match> inlier_matches(const std::vector<Match>& matches, const RelativePose& relative) {
  std::vector<Match> inliers;
  for (const std::size_t i : relative.inliers) inliers.push_back(matches[i]);
  return inliers;
}

double other_log_likelihood(const PoseCandidate& candidate, const std::optional<PosePrior>& prior) {
  double sum = candidate.scale ? candidate.scale->log_likelihood : 0.0;
  if (!prior) return sum;
  const bool is_metric = candidate.scale && candidate.scale->agrees;
  Pose pose = candidate.relative.match_from_query;
  pose.translation *= is_metric ? candidate.scale->baseline : prior->match_from_query.translation.norm();
  return sum + prior_log_likelihood(squared_distance(pose, *prior), 6);
}

/// As how many independent pairs so many count. What is left of a lens's distortion, or of a rolling shutter, is the same for
/// pairs that lie near one another, a twentieth of the image say: however many they are, the image has 400 such parts, and the
/// two poses take such errors up in different ways.
double num_independent(double count) {
  constexpr double kNumParts = 400;
  return count / (1.0 + count / kNumParts);
}

/// Of each pair: log(1 + n N(r) / floor) with the true pairs' number and noise, where one accident is expected a threshold.
std::vector<double> scores_of(const EpipolarEquations& equations, const RelativePose& relative, double max_error_rad) {
  std::vector<double> scores = equations.angles(frame_of(relative.match_from_query), max_error_rad);
  const double num_per_density = relative.num_true * max_error_rad;
  for (double& score : scores) {
    const bool is_within = std::abs(score) < max_error_rad;
    score = is_within ? std::log1p(num_per_density * normal_density(score, relative.noise_rad)) : 0.0;
  }
  return scores;
}

/// Luck: each pose's noise, estimated from n independent residuals, is known to 1 / sqrt(2 n), relative, so that n times the
/// difference of their logarithms has a standard deviation of sqrt(n). (The differences' own scatter, as in Vuong's test, is
/// less, but says nothing of errors of the lens.)
double lead_over(const PoseCandidate& candidate, const PoseCandidate& other) {
  constexpr double kSigmas = 3.0;
  double count = 0, sum = 0;
  for (std::size_t i = 0; i < candidate.pair_scores.size(); ++i) {
    sum += candidate.pair_scores[i] - other.pair_scores[i];
    count += candidate.pair_scores[i] > 0 || other.pair_scores[i] > 0;
  }
  if (count == 0) return candidate.other_score - other.other_score;
  const double difference = num_independent(count) / count * sum;
  const double luck = kSigmas * std::sqrt(num_independent(count));
  const double beyond_luck = std::copysign(std::max(0.0, std::abs(difference) - luck), difference);
  return beyond_luck + candidate.other_score - other.other_score;
}

double least_lead(const std::vector<PoseCandidate>& candidates, std::size_t c) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t other = 0; other < candidates.size(); ++other) {
    if (other != c) least = std::min(least, lead_over(candidates[c], candidates[other]));
  }
  return least;
}

}  // namespace

PoseChoice choose_pose(const View& query, const View& match, const std::vector<Match>& matches, std::span<const RayPair> pairs,
                       RelativePose relative, const PoseChoiceOptions& options, const std::optional<PosePrior>& prior,
                       std::span<const RayPair> set_aside) {
  PlanarScene scene = planar_scene(pairs, relative, options.pose);
  std::vector<PoseCandidate> candidates;
  if (scene.closer) {
    scene.closer->iterations = relative.iterations;
    relative = std::move(*scene.closer);
  }
  candidates.push_back({std::move(relative), {}, 0, {}, 0});
  for (RelativePose& rival : scene.rivals) candidates.push_back({std::move(rival), {}, 0, {}, 0});
  for (PoseCandidate& candidate : candidates) {
    const std::vector<Match> inliers = inlier_matches(matches, candidate.relative);
    const Pose& pose = candidate.relative.match_from_query;
    candidate.scale = estimate_scale(query, match, inliers, pose, options.scale);
    candidate.unit_sigma = candidate.scale ? std::max(query.unit_sigma, match.unit_sigma) : 0.0;
    if (candidate.scale && candidate.unit_sigma <= options.plane_scale.height_sigma) continue;
    if (auto of_plane = estimate_plane_scale(query, match, inliers, pose, options.plane_scale)) {
      candidate.scale = of_plane;
      candidate.unit_sigma = 0;
    }
  }
  std::vector<RayPair> scored(pairs.begin(), pairs.end());
  scored.insert(scored.end(), set_aside.begin(), set_aside.end());
  const EpipolarEquations equations = equations_of(scored);
  for (PoseCandidate& candidate : candidates) {
    candidate.pair_scores = scores_of(equations, candidate.relative, options.pose.max_error_rad);
    candidate.other_score = other_log_likelihood(candidate, prior);
  }
  std::size_t best = 0;
  for (std::size_t c = 1; c < candidates.size(); ++c) {
    if (least_lead(candidates, c) > least_lead(candidates, best)) best = c;
  }
  PoseChoice choice;
  if (candidates.size() > 1) choice.lead = least_lead(candidates, best);
  choice.chosen = std::move(candidates[best]);
  return choice;
}

double squared_distance(const Pose& match_from_query, const PosePrior& prior) {
  const Eigen::Matrix<double, 6, 1> error = pose_error(prior.match_from_query, match_from_query);
  return error.dot(prior.covariance.ldlt().solve(error));
}

double prior_log_likelihood(double squared_distance, int degrees_of_freedom) {
  constexpr double kTail = 4.0;
  return -0.5 * (kTail + degrees_of_freedom) * std::log1p(squared_distance / kTail);
}

}  // namespace fabloop
