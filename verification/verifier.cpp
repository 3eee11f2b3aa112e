// SPDX-License-Identifier: BSD-3-Clause
#include "verification/verifier.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "verification/edge_information.h"
#include "verification/evidence.h"
#include "verification/inlier_spread.h"
#include "verification/joint_pose.h"
#include "verification/loop_probability.h"
#include "verification/median.h"
#include "verification/metric_pose.h"
#include "verification/ray_pairs.h"
#include "verification/relative_pose.h"
#include "verification/residuals.h"

namespace fabloop {
namespace {

constexpr double kFivePointModels = 10;

/// Whether the points of the match and those of the query tell the same pose, as far as both are known.
bool sides_agree(const MetricPoses& poses, double field_of_view_rad, const VerifierOptions& options) {
  if (!poses.from_match_points || !poses.from_query_points) return true;
  const Pose& a = poses.from_match_points->match_from_query;
  const Pose& b = poses.from_query_points->match_from_query;
  const MetricPose& best = *poses.best();
  constexpr double kSigmas = 3.0;
  const double allowed = kSigmas * (options.max_translation_sigma * best.median_depth +
                                    options.scale_sigma * best.match_from_query.translation.norm());
  return (a.translation - b.translation).norm() < allowed &&
         a.rotation.angularDistance(b.rotation) < kSigmas * options.max_rotation_sigma * field_of_view_rad;
}

/// Every match of the two views, with the points that either side knows.
JointData joint_data(const View& query, const View& match, const std::vector<Match>& matches, const std::vector<RayPair>& pairs) {
  JointData data{pairs, {}, {}};
  for (const Match& m : matches) {
    const auto q = static_cast<std::size_t>(m.query);
    const auto k = static_cast<std::size_t>(m.match);
    if (match.points_in_camera[k]) data.match_points.push_back({*match.points_in_camera[k], query.rays[q]});
    if (query.points_in_camera[q]) data.query_points.push_back({*query.points_in_camera[q], match.rays[k]});
  }
  return data;
}

/// Largest number of inliers that the matches left by a pose have for another one.
int second_support(std::span<const RayPair> pairs, const RelativePose& first, const RelativePoseOptions& pose_options,
                   const VerifierOptions& options) {
  std::vector<RayPair> left;
  std::size_t next = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (next < first.inliers.size() && first.inliers[next] == i) {
      ++next;
    } else {
      left.push_back(pairs[i]);
    }
  }
  RelativePoseOptions second = pose_options;
  second.min_inliers = static_cast<std::size_t>(std::ceil(options.max_second_support * first.num_true));
  if (left.size() < std::max<std::size_t>(second.min_inliers, 6)) return 0;
  const auto other = estimate_relative_pose(left, second);
  return other ? static_cast<int>(other->inliers.size()) : 0;
}

double field_of_view_rad(const Camera& camera) {
  const double half_diagonal_px = 0.5 * std::hypot(camera.width, camera.height);
  return 2.0 * std::atan(half_diagonal_px / camera.focal_px());
}

/// States the distance, or where it is too vague against the depth the direction alone.
void state_distance(const EdgeInformation& edge, double distance, double relative_sigma, double median_depth,
                    const VerifierOptions& options, Verification& result) {
  result.has_scale = relative_sigma * distance <= options.max_distance_sigma * median_depth;
  result.scale_sigma = result.has_scale ? relative_sigma : 0;
  result.information = edge.information;
  if (result.has_scale) return;
  result.information = without_scale(edge.information, result.match_from_query);
  result.match_from_query.translation /= distance;
}

/// Without parallax: the pose from known points, refined on rays and points together.
void decide_by_points(const View& query, const View& match, const std::vector<Match>& matches, const std::vector<RayPair>& pairs,
                      const RelativePoseOptions& pose_options, const VerifierOptions& options, Verification& result) {
  const double max_point_error_rad = options.max_point_error_px / match.camera.focal_px();
  const MetricPoses metric =
      estimate_metric_poses(query, match, result.inliers,
                            {options.scale.min_points, options.max_point_error_px, options.confidence, pose_options.seed});
  result.verdict = Verdict::NoParallax;
  if (!metric.best()) return;
  const JointPose joint = refine_joint_pose(joint_data(query, match, matches, pairs), metric.best()->match_from_query,
                                            {pose_options.max_error_rad, max_point_error_rad});
  const EdgeInformation edge =
      metric_edge_information(joint.match_from_query, joint.covariance, joint.median_depth, options.scale_sigma);
  result.match_from_query = joint.match_from_query;
  result.num_point_inliers = static_cast<int>(joint.num_point_inliers);
  result.rotation_sigma_deg = deg_from_rad(edge.rotation_sigma_rad);
  result.translation_sigma = edge.translation_sigma / joint.median_depth;
  const double distance = joint.match_from_query.translation.norm();
  result.baseline_to_depth = distance / joint.median_depth;
  const bool rays_agree = static_cast<double>(joint.pair_inliers.size()) >= options.min_ray_inlier_ratio * result.num_inliers;
  const bool points_agree =
      metric.best()->inlier_ratio >= options.min_point_inlier_ratio && result.num_point_inliers >= options.scale.min_points;
  state_distance(edge, distance, options.scale_sigma, joint.median_depth, options, result);
  const bool agree = rays_agree && points_agree && sides_agree(metric, field_of_view_rad(match.camera), options);
  result.verdict = agree ? Verdict::Accepted : Verdict::ScaleDisagrees;
}

/// Median depth of the inliers from the match, with a baseline of one.
double depth_per_baseline(std::span<const RayPair> pairs, const RelativePose& relative) {
  std::vector<double> depths;
  for (const std::size_t i : relative.inliers) {
    const Eigen::Vector3d query_ray = relative.match_from_query.rotation * pairs[i].query;
    const RayDepths found = ray_depths(query_ray, pairs[i].match, relative.match_from_query.translation);
    if (found.squared_sine > 0) depths.push_back(found.match / found.squared_sine);
  }
  return median(std::move(depths));
}

/// With parallax: rotation and direction from the rays, the length from the points where they tell one.
void decide_by_rays(std::span<const RayPair> pairs, const PoseCandidate& chosen, const VerifierOptions& options,
                    Verification& result) {
  const RelativePose& relative = chosen.relative;
  const EdgeInformation direction = direction_edge_information(relative);
  const double depth = depth_per_baseline(pairs, relative);
  result.match_from_query = relative.match_from_query;
  result.rotation_sigma_deg = deg_from_rad(direction.rotation_sigma_rad);
  result.translation_sigma = direction.translation_sigma / depth;
  result.baseline_to_depth = 1.0 / depth;
  result.information = direction.information;
  result.verdict = Verdict::Accepted;
  if (chosen.scale && !chosen.scale->agrees) {
    result.verdict = Verdict::ScaleDisagrees;
  } else if (chosen.scale) {
    const Scale& scale = *chosen.scale;
    const double relative_sigma = std::hypot(scale.relative_sigma, options.scale_sigma);
    result.num_point_inliers = scale.num_points;
    result.match_from_query.translation *= scale.baseline;
    const EdgeInformation edge =
        metric_edge_information(result.match_from_query, scaled_covariance(relative, scale.baseline, scale.relative_sigma),
                                scale.median_depth, options.scale_sigma);
    state_distance(edge, scale.baseline, relative_sigma, scale.median_depth, options, result);
  }
  if (result.verdict == Verdict::Accepted && !result.has_scale && direction.translation_sigma > options.max_direction_sigma) {
    result.verdict = Verdict::PoorlyConstrained;
  }
}

LoopEvidence evidence_of(const Verification& found, const PairPrior& prior) {
  LoopEvidence evidence;
  evidence.p_appearance = prior.p_appearance;
  evidence.log10_false_alarms = found.log10_false_alarms;
  if (!prior.pose || found.information.isZero()) return evidence;
  Pose pose = found.match_from_query;
  if (!found.has_scale) pose.translation *= prior.pose->match_from_query.translation.norm();
  evidence.squared_distance = squared_distance(pose, *prior.pose);
  evidence.degrees_of_freedom = found.has_scale ? 6 : 5;
  return evidence;
}

}  // namespace

std::uint64_t pair_seed(std::uint64_t seed, std::size_t query, std::size_t match) {
  std::uint64_t state = seed;
  for (const std::uint64_t value : {static_cast<std::uint64_t>(query), static_cast<std::uint64_t>(match)}) {
    state += 0x9e3779b97f4a7c15 + value;  // splitmix64 (Steele et al. 2014)
    state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9;
    state = (state ^ (state >> 27)) * 0x94d049bb133111eb;
    state ^= state >> 31;
  }
  return state;
}

Verification Verifier::verify(const View& query, const View& match, const PairPrior& prior) const {
  Verification result;
  const std::vector<Match> matches = match_features(query.features, match.features, options_.matching);
  result.num_matches = static_cast<int>(matches.size());
  if (result.num_matches < options_.min_matches) return result;

  const std::vector<RayPair> pairs = ray_pairs(query, match, matches);
  RelativePoseOptions pose_options;
  pose_options.max_error_rad = options_.max_error_px / match.camera.focal_px();
  pose_options.confidence = options_.confidence;
  pose_options.max_iterations = options_.max_iterations;
  pose_options.seed = pair_seed(options_.seed, query.frame, match.frame);
  pose_options.min_inliers = static_cast<std::size_t>(std::max(0, options_.min_inliers));
  auto best = estimate_relative_pose(pairs, pose_options);
  result.verdict = Verdict::NoPose;
  if (!best) return result;
  result.num_iterations = best->iterations;
  const PoseChoice choice = choose_pose(query, match, matches, pairs, std::move(*best), pose_options, options_.scale, prior.pose);
  const RelativePose& relative = choice.chosen.relative;

  for (const std::size_t i : relative.inliers) result.inliers.push_back(matches[i]);
  result.match_from_query = relative.match_from_query;
  result.num_inliers = static_cast<int>(relative.inliers.size());
  result.num_true = relative.num_true;
  result.rms_error_px = relative.noise_rad * match.camera.focal_px();
  result.median_parallax_deg = deg_from_rad(median_parallax(pairs, relative.inliers, relative.match_from_query));
  const double p_accident = p_accidental_epipolar_match(match.camera.width, match.camera.height, options_.max_error_px);
  result.log10_false_alarms = log10_false_alarms(pairs.size(), relative.inliers.size(), 5, p_accident, kFivePointModels);
  result.p_true = loop_probability({prior.p_appearance, result.log10_false_alarms, {}, {}});
  result.verdict = Verdict::TooFewInliers;
  if (result.num_inliers < options_.min_inliers) return result;
  result.verdict = Verdict::AccidentalInliers;
  if (result.log10_false_alarms > options_.max_log10_false_alarms) return result;

  const InlierSpread spread = inlier_spread(query, match, result.inliers);
  result.inlier_area = std::min(spread.query.hull_share, spread.match.hull_share);
  result.inlier_cells = std::min(spread.query.cell_share, spread.match.cell_share);
  result.verdict = Verdict::InliersInCorner;
  if (result.inlier_area < options_.min_inlier_area) return result;

  result.num_second_inliers = second_support(pairs, relative, pose_options, options_);
  result.verdict = Verdict::RepeatedTexture;
  if (result.num_second_inliers >= options_.max_second_support * result.num_true) return result;

  // What a rotation leaves has two components and both images' noise; a few inliers may tell too small a noise.
  const double max_rotation_error_rad = std::max(4.0 * relative.noise_rad, 0.5 * pose_options.max_error_rad);
  result.rotation_share = fit_rotation(pairs, relative.inliers, max_rotation_error_rad).share;
  if (result.rotation_share > options_.max_rotation_share) {
    decide_by_points(query, match, matches, pairs, pose_options, options_, result);
  } else {
    result.planar_lead = choice.lead;
    result.verdict = Verdict::AmbiguousPose;
    if (choice.lead && *choice.lead < kMinLead) return result;
    decide_by_rays(pairs, choice.chosen, options_, result);
  }
  const bool vague = rad_from_deg(result.rotation_sigma_deg) > options_.max_rotation_sigma * field_of_view_rad(match.camera) ||
                     result.translation_sigma > options_.max_translation_sigma;
  if (result.verdict == Verdict::Accepted && vague) result.verdict = Verdict::PoorlyConstrained;
  result.p_true = loop_probability(evidence_of(result, prior));
  if (result.verdict == Verdict::Accepted && result.p_true < options_.min_probability) result.verdict = Verdict::Improbable;
  return result;
}

}  // namespace fabloop
