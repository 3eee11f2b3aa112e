// SPDX-License-Identifier: BSD-3-Clause
#include "verification/verifier.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "verification/absolute_pose.h"
#include "verification/evidence.h"
#include "verification/planar_ambiguity.h"
#include "verification/relative_pose.h"

namespace fabloop {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// What the inliers' scatter does not show: lens calibration, moving shutters, points that share one baseline's error.
constexpr double kUnmodelledRotationRad = 0.003;
constexpr double kUnmodelledTranslation = 0.01;      ///< Share of the median depth.
constexpr double kUnmodelledDirectionRad = 0.01;
constexpr double kFivePointModels = 10;

double largest_sigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues()(2)));
}

std::vector<RayPair> ray_pairs(const View& query, const View& match, const std::vector<Match>& matches) {
  std::vector<RayPair> pairs;
  pairs.reserve(matches.size());
  for (const Match& m : matches) {
    pairs.push_back({query.rays[static_cast<std::size_t>(m.query)], match.rays[static_cast<std::size_t>(m.match)]});
  }
  return pairs;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Known points of one view and the other view's rays to them, in the order of the matches.
std::vector<PointRay> points_seen_by_query(const View& query, const View& match, const std::vector<Match>& matches) {
  std::vector<PointRay> data;
  for (const Match& m : matches) {
    const auto& point = match.points_in_camera[static_cast<std::size_t>(m.match)];
    if (point) data.push_back({*point, query.rays[static_cast<std::size_t>(m.query)]});
  }
  return data;
}

std::vector<PointRay> points_seen_by_match(const View& query, const View& match, const std::vector<Match>& matches) {
  std::vector<PointRay> data;
  for (const Match& m : matches) {
    const auto& point = query.points_in_camera[static_cast<std::size_t>(m.query)];
    if (point) data.push_back({*point, match.rays[static_cast<std::size_t>(m.match)]});
  }
  return data;
}

/// A metric pose and how well it is known.
struct MetricPose {
  Pose match_from_query;
  Matrix6d covariance;  ///< Of (translation in the query, rotation in the query), the inliers' noise alone.
  int num_inliers = 0;
  double inlier_ratio = 0;
  double median_depth = 0;
};

std::optional<MetricPose> metric_pose(const std::vector<PointRay>& data, const VerifierOptions& options, double max_error_rad,
                                      std::uint64_t seed) {
  if (static_cast<int>(data.size()) < options.min_points) return std::nullopt;
  AbsolutePoseOptions pose_options;
  pose_options.max_error_rad = max_error_rad;
  pose_options.confidence = options.confidence;
  pose_options.seed = seed;
  const auto pose = estimate_absolute_pose(data, pose_options);
  if (!pose) return std::nullopt;
  std::vector<double> depths;
  for (const std::size_t i : pose->inliers) depths.push_back((data[i].point_in_world - pose->world_from_camera.translation).norm());
  MetricPose metric{pose->world_from_camera, Matrix6d::Zero(), static_cast<int>(pose->inliers.size()), 0, median(std::move(depths))};
  metric.inlier_ratio = static_cast<double>(pose->inliers.size()) / static_cast<double>(data.size());
  // Translation from the world's axes to the camera's, in which a pose-graph edge states it.
  Matrix6d world_from_edge = Matrix6d::Identity();
  world_from_edge.topLeftCorner<3, 3>() = pose->world_from_camera.rotation.toRotationMatrix();
  const Matrix6d information = world_from_edge.transpose() * pose->information * world_from_edge;
  metric.covariance = (information + 1e-9 * information.trace() * Matrix6d::Identity()).inverse();
  return metric;
}

/// The metric pose from the match's points, or from the query's, whichever has more support. When both exist they must agree.
struct MetricOutcome {
  std::optional<MetricPose> pose;
  bool sides_disagree = false;
};

MetricOutcome metric_pose_of_either_side(const View& query, const View& match, const std::vector<Match>& inliers,
                                         const VerifierOptions& options, std::uint64_t seed) {
  const auto from_match_points = metric_pose(points_seen_by_query(query, match, inliers), options,
                                             options.max_point_error_px / query.camera.focal_px(), seed);
  auto from_query_points = metric_pose(points_seen_by_match(query, match, inliers), options,
                                       options.max_point_error_px / match.camera.focal_px(), seed + 1);
  if (from_query_points) {  // it is query_from_match so far, with axes of the match
    const Pose match_from_query = from_query_points->match_from_query.inverse();
    Matrix6d adjoint = Matrix6d::Zero();  // how a change of query_from_match changes its inverse
    const Eigen::Matrix3d rotation = from_query_points->match_from_query.rotation.toRotationMatrix();
    adjoint.topLeftCorner<3, 3>() = -rotation;
    adjoint.topRightCorner<3, 3>() = -cross_matrix(from_query_points->match_from_query.translation) * rotation;
    adjoint.bottomRightCorner<3, 3>() = -rotation;
    from_query_points->covariance = (adjoint * from_query_points->covariance * adjoint.transpose()).eval();
    from_query_points->match_from_query = match_from_query;
  }
  if (!from_match_points || !from_query_points) return {from_match_points ? from_match_points : from_query_points, false};
  const bool prefer_match = from_match_points->num_inliers >= from_query_points->num_inliers;
  const MetricPose& best = prefer_match ? *from_match_points : *from_query_points;
  const Pose& a = from_match_points->match_from_query;
  const Pose& b = from_query_points->match_from_query;
  const double allowed = 3.0 * (options.max_translation_sigma * best.median_depth + options.scale_sigma * best.match_from_query.translation.norm());
  const bool agree = (a.translation - b.translation).norm() < allowed &&
                     deg_from_rad(a.rotation.angularDistance(b.rotation)) < 3.0 * options.max_rotation_sigma_deg;
  return {best, !agree};
}

void state_metric_pose(const MetricPose& metric, const VerifierOptions& options, Verification& result) {
  result.has_scale = true;
  result.match_from_query = metric.match_from_query;
  result.num_point_inliers = metric.num_inliers;
  result.rotation_sigma_deg = deg_from_rad(largest_sigma(metric.covariance.bottomRightCorner<3, 3>()));
  result.translation_sigma = largest_sigma(metric.covariance.topLeftCorner<3, 3>()) / metric.median_depth;
  const Eigen::Vector3d baseline_in_query = metric.match_from_query.rotation.conjugate() * metric.match_from_query.translation;
  Matrix6d covariance = metric.covariance;
  covariance.topLeftCorner<3, 3>() += std::pow(kUnmodelledTranslation * metric.median_depth, 2) * Eigen::Matrix3d::Identity() +
                                      std::pow(options.scale_sigma, 2) * baseline_in_query * baseline_in_query.transpose();
  covariance.bottomRightCorner<3, 3>() += std::pow(kUnmodelledRotationRad, 2) * Eigen::Matrix3d::Identity();
  result.information = covariance.inverse();
  result.information = (0.5 * (result.information + result.information.transpose())).eval();
}

void state_direction(const RelativePose& relative, Verification& result) {
  result.has_scale = false;
  result.match_from_query = relative.match_from_query;
  using Matrix5d = Eigen::Matrix<double, 5, 5>;
  Matrix5d covariance = (relative.information + 1e-9 * relative.information.trace() * Matrix5d::Identity()).inverse();
  result.rotation_sigma_deg = deg_from_rad(largest_sigma(covariance.topLeftCorner<3, 3>()));
  result.translation_sigma =
      std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance.bottomRightCorner<2, 2>(), Eigen::EigenvaluesOnly).eigenvalues()(1));
  covariance.topLeftCorner<3, 3>() += std::pow(kUnmodelledRotationRad, 2) * Eigen::Matrix3d::Identity();
  covariance.bottomRightCorner<2, 2>() += std::pow(kUnmodelledDirectionRad, 2) * Eigen::Matrix2d::Identity();
  // From (rotation, tangent plane in the match) to (translation in the query, rotation).
  Eigen::Matrix<double, 5, 6> from_edge = Eigen::Matrix<double, 5, 6>::Zero();
  from_edge.topRightCorner<3, 3>().setIdentity();
  from_edge.bottomLeftCorner<2, 3>() = relative.direction_basis.transpose() * relative.match_from_query.rotation.toRotationMatrix();
  result.information = from_edge.transpose() * covariance.inverse() * from_edge;
  result.information = (0.5 * (result.information + result.information.transpose())).eval();
}

Verdict metric_verdict(const MetricOutcome& metric, const VerifierOptions& options, const Verification& result) {
  if (metric.sides_disagree || metric.pose->inlier_ratio < options.min_point_inlier_ratio) return Verdict::ScaleDisagrees;
  const bool vague = result.rotation_sigma_deg > options.max_rotation_sigma_deg || result.translation_sigma > options.max_translation_sigma;
  return vague ? Verdict::PoorlyConstrained : Verdict::Accepted;
}

Verdict direction_verdict(std::span<const RayPair> pairs, const RelativePose& relative, const RelativePoseOptions& pose_options,
                          const VerifierOptions& options, const Verification& result) {
  if (result.median_parallax_deg < options.min_parallax_deg) return Verdict::NoParallax;
  if (has_planar_rival(pairs, relative, pose_options)) return Verdict::AmbiguousPose;
  const bool vague = result.rotation_sigma_deg > options.max_rotation_sigma_deg ||
                     deg_from_rad(result.translation_sigma) > options.max_direction_sigma_deg;
  return vague ? Verdict::PoorlyConstrained : Verdict::Accepted;
}

}  // namespace

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::Accepted: return "Accepted";
    case Verdict::TooFewMatches: return "TooFewMatches";
    case Verdict::NoPose: return "NoPose";
    case Verdict::TooFewInliers: return "TooFewInliers";
    case Verdict::AccidentalInliers: return "AccidentalInliers";
    case Verdict::NoParallax: return "NoParallax";
    case Verdict::AmbiguousPose: return "AmbiguousPose";
    case Verdict::ScaleDisagrees: return "ScaleDisagrees";
    case Verdict::PoorlyConstrained: return "PoorlyConstrained";
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

  const MetricOutcome metric = metric_pose_of_either_side(query, match, result.inliers, options_, pose_options.seed);
  if (metric.pose) {
    state_metric_pose(*metric.pose, options_, result);
    result.verdict = metric_verdict(metric, options_, result);
  } else {
    state_direction(*relative, result);
    result.verdict = direction_verdict(pairs, *relative, pose_options, options_, result);
  }
  return result;
}

}  // namespace fabloop
