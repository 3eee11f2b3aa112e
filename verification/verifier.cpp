// SPDX-License-Identifier: BSD-3-Clause
#include "verification/verifier.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <span>
#include <vector>

#include "verification/edge_information.h"
#include "verification/evidence.h"
#include "verification/joint_pose.h"
#include "verification/metric_pose.h"
#include "verification/planar_ambiguity.h"
#include "verification/relative_pose.h"

namespace fabloop {
namespace {

constexpr double kFivePointModels = 10;

std::vector<RayPair> ray_pairs(const View& query, const View& match, const std::vector<Match>& matches) {
  std::vector<RayPair> pairs;
  pairs.reserve(matches.size());
  for (const Match& m : matches) {
    pairs.push_back({query.rays[static_cast<std::size_t>(m.query)], match.rays[static_cast<std::size_t>(m.match)]});
  }
  return pairs;
}

/// Share of an image inside the convex hull of some of its keypoints. The tenth furthest from their middle is left out: a few
/// accidental inliers must not widen it.
template <typename Index>
double hull_share(const View& view, const std::vector<Match>& inliers, Index index) {
  std::vector<cv::Point2f> points;
  for (const Match& inlier : inliers) points.push_back(view.features.keypoints[static_cast<std::size_t>(inlier.*index)].pt);
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  std::nth_element(points.begin(), middle, points.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  const float x = middle->x;
  std::nth_element(points.begin(), middle, points.end(), [](const auto& a, const auto& b) { return a.y < b.y; });
  const cv::Point2f centre(x, middle->y);
  std::sort(points.begin(), points.end(),
            [&](const auto& a, const auto& b) { return cv::norm(a - centre) < cv::norm(b - centre); });
  points.resize(points.size() - points.size() / 10);
  std::vector<cv::Point2f> hull;
  cv::convexHull(points, hull);
  return cv::contourArea(hull) / (static_cast<double>(view.camera.width) * view.camera.height);
}

/// Whether the points of the match and those of the query tell the same pose, as far as both are known.
bool sides_agree(const MetricPoses& poses, const VerifierOptions& options) {
  if (!poses.from_match_points || !poses.from_query_points) return true;
  const Pose& a = poses.from_match_points->match_from_query;
  const Pose& b = poses.from_query_points->match_from_query;
  const MetricPose& best = *poses.best();
  constexpr double kSigmas = 3.0;
  const double allowed = kSigmas * (options.max_translation_sigma * best.median_depth +
                                    options.scale_sigma * best.match_from_query.translation.norm());
  return (a.translation - b.translation).norm() < allowed &&
         deg_from_rad(a.rotation.angularDistance(b.rotation)) < kSigmas * options.max_rotation_sigma_deg;
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

/// The verdict on a metric pose that was refined on everything, and what the loop states: a distance too vague against the
/// depth is left out, the direction stays.
void decide_metric(const MetricPoses& poses, const JointPose& joint, const VerifierOptions& options, Verification& result) {
  const EdgeInformation edge =
      metric_edge_information(joint.match_from_query, joint.covariance, joint.median_depth, options.scale_sigma);
  result.has_scale = true;
  result.match_from_query = joint.match_from_query;
  result.information = edge.information;
  result.num_point_inliers = static_cast<int>(joint.num_point_inliers);
  result.rotation_sigma_deg = deg_from_rad(edge.rotation_sigma_rad);
  result.translation_sigma = edge.translation_sigma / joint.median_depth;
  const bool rays_agree = static_cast<double>(joint.pair_inliers.size()) >= options.min_ray_inlier_ratio * result.num_inliers;
  const bool points_agree =
      poses.best()->inlier_ratio >= options.min_point_inlier_ratio && result.num_point_inliers >= options.min_points;
  if (!rays_agree || !points_agree || !sides_agree(poses, options)) {
    result.verdict = Verdict::ScaleDisagrees;
    return;
  }
  const bool vague =
      result.rotation_sigma_deg > options.max_rotation_sigma_deg || result.translation_sigma > options.max_translation_sigma;
  result.verdict = vague ? Verdict::PoorlyConstrained : Verdict::Accepted;
  const double distance = joint.match_from_query.translation.norm();
  if (options.scale_sigma * distance > options.max_distance_sigma * joint.median_depth) {
    result.has_scale = false;
    result.match_from_query.translation /= distance;
    result.information = without_scale(edge.information, joint.match_from_query);
  }
}

void decide_direction(std::span<const RayPair> pairs, const RelativePose& relative, const RelativePoseOptions& pose_options,
                      const VerifierOptions& options, Verification& result) {
  const EdgeInformation edge = direction_edge_information(relative);
  result.has_scale = false;
  result.match_from_query = relative.match_from_query;
  result.information = edge.information;
  result.rotation_sigma_deg = deg_from_rad(edge.rotation_sigma_rad);
  result.translation_sigma = edge.translation_sigma;
  if (result.median_parallax_deg < options.min_parallax_deg) {
    result.verdict = Verdict::NoParallax;
  } else if (has_planar_rival(pairs, relative, pose_options)) {
    result.verdict = Verdict::AmbiguousPose;
  } else {
    const bool vague = result.rotation_sigma_deg > options.max_rotation_sigma_deg ||
                       deg_from_rad(result.translation_sigma) > options.max_direction_sigma_deg;
    result.verdict = vague ? Verdict::PoorlyConstrained : Verdict::Accepted;
  }
}

}  // namespace

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::Accepted:
      return "Accepted";
    case Verdict::TooFewMatches:
      return "TooFewMatches";
    case Verdict::NoPose:
      return "NoPose";
    case Verdict::TooFewInliers:
      return "TooFewInliers";
    case Verdict::AccidentalInliers:
      return "AccidentalInliers";
    case Verdict::InliersInCorner:
      return "InliersInCorner";
    case Verdict::NoParallax:
      return "NoParallax";
    case Verdict::AmbiguousPose:
      return "AmbiguousPose";
    case Verdict::ScaleDisagrees:
      return "ScaleDisagrees";
    case Verdict::PoorlyConstrained:
      return "PoorlyConstrained";
    case Verdict::Unconfirmed:
      return "Unconfirmed";
    case Verdict::ContradictsMap:
      return "ContradictsMap";
  }
  return "";
}

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

Verification Verifier::verify(const View& query, const View& match) const {
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
  const auto relative = estimate_relative_pose(pairs, pose_options);
  result.verdict = Verdict::NoPose;
  if (!relative) return result;

  for (const std::size_t i : relative->inliers) result.inliers.push_back(matches[i]);
  result.num_inliers = static_cast<int>(relative->inliers.size());
  result.num_iterations = relative->iterations;
  result.rms_error_px = relative->rms_error_rad * match.camera.focal_px();
  result.median_parallax_deg = deg_from_rad(median_parallax(pairs, relative->inliers, relative->match_from_query));
  const double p_accident = p_accidental_epipolar_match(match.camera.width, match.camera.height, options_.max_error_px);
  result.log10_false_alarms = log10_false_alarms(pairs.size(), relative->inliers.size(), 5, p_accident, kFivePointModels);
  result.verdict = Verdict::TooFewInliers;
  if (result.num_inliers < options_.min_inliers) return result;
  result.verdict = Verdict::AccidentalInliers;
  if (result.log10_false_alarms > options_.max_log10_false_alarms) return result;

  result.inlier_area =
      std::min(hull_share(query, result.inliers, &Match::query), hull_share(match, result.inliers, &Match::match));
  result.verdict = Verdict::InliersInCorner;
  if (result.inlier_area < options_.min_inlier_area) return result;

  const MetricPoses metric = estimate_metric_poses(
      query, match, result.inliers, {options_.min_points, options_.max_point_error_px, options_.confidence, pose_options.seed});
  if (metric.best()) {
    const JointPose joint =
        refine_joint_pose(joint_data(query, match, matches, pairs), metric.best()->match_from_query,
                          {pose_options.max_error_rad, options_.max_point_error_px / match.camera.focal_px()});
    decide_metric(metric, joint, options_, result);
  } else {
    decide_direction(pairs, *relative, pose_options, options_, result);
  }
  return result;
}

}  // namespace fabloop
