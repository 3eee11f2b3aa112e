// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pair_decision.h"

#include <cmath>
#include <utility>

#include "verification/edge_information.h"
#include "verification/median.h"
#include "verification/pose/joint_pose.h"
#include "verification/pose/metric_pose.h"
#include "verification/pose/residuals.h"

namespace fabloop {
namespace {

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

}  // namespace

double field_of_view_rad(const Camera& camera) {
  const double half_diagonal_px = 0.5 * std::hypot(camera.width, camera.height);
  return 2.0 * std::atan(half_diagonal_px / camera.focal_px());
}

void decide_by_points(const View& query, const View& match, const std::vector<Match>& matches, const std::vector<RayPair>& pairs,
                      const RelativePoseOptions& pose_options, const VerifierOptions& options, Verification& result) {
  const double max_point_error_rad = options.max_point_error_px / feature_focal_px(match);
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

}  // namespace fabloop
