// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/plane_scale.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>

#include "verification/median.h"
#include "verification/pose/residuals.h"

namespace fabloop {
namespace {

/// Below this share of its largest eigenvalue the smallest one of the normal equations leaves the plane open.
constexpr double kMinReciprocalCondition = 1e-9;

/// Normal equations of inverse_normal . (depth ray) = 1: in units of the depth, so that far points count as near ones do.
struct PlaneEquations {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();

  void add(const Eigen::Vector3d& ray, double depth) {
    const Eigen::Vector3d row = depth * ray;
    matrix += row * row.transpose();
    right += row;
  }
  std::optional<Eigen::Vector3d> solve() const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(matrix);
    if (!(eigen.eigenvalues()(0) > kMinReciprocalCondition * eigen.eigenvalues()(2))) return std::nullopt;
    return matrix.ldlt().solve(right);
  }
};

/// How far a point is off the plane, relative to its depth.
double relative_offset(const Eigen::Vector3d& inverse_normal, const Eigen::Vector3d& ray, double depth) {
  return inverse_normal.dot(ray) * depth - 1.0;
}

/// The matches as points in front of both cameras, with a baseline of one.
struct MatchPoints {
  std::vector<Eigen::Vector3d> rays;  ///< Of the match.
  std::vector<double> depths;         ///< Along them.
};

MatchPoints match_points(const View& query, const View& match, const std::vector<Match>& matches, const Pose& match_from_query,
                         double min_parallax_rad) {
  MatchPoints points;
  for (const Match& m : matches) {
    const Eigen::Vector3d& ray = match.rays[static_cast<std::size_t>(m.match)];
    const Eigen::Vector3d query_ray = match_from_query.rotation * query.rays[static_cast<std::size_t>(m.query)];
    const RayDepths depths = ray_depths(query_ray, ray, match_from_query.translation);
    if (depths.squared_sine < min_parallax_rad * min_parallax_rad || depths.query <= 0 || depths.match <= 0) continue;
    points.rays.push_back(ray);
    points.depths.push_back(depths.match / depths.squared_sine);
  }
  return points;
}

/// Points as rays and depths, and which of them are on a plane.
struct PointsAndPlane {
  const std::vector<Eigen::Vector3d>& rays;
  const std::vector<double>& depths;
  double max_relative_error;

  bool is_on(const Eigen::Vector3d& inverse_normal, std::size_t i) const {
    return std::abs(relative_offset(inverse_normal, rays[i], depths[i])) < max_relative_error;
  }
  std::size_t num_on(const Eigen::Vector3d& inverse_normal) const {
    std::size_t sum = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) sum += is_on(inverse_normal, i);
    return sum;
  }
};

/// Of the planes through three points drawn, the one that most points are on.
std::optional<Eigen::Vector3d> drawn_plane(const PointsAndPlane& points) {
  // All but one in 5,000 of such searches draw three points of the plane when half of them are off it.
  constexpr int kDraws = 64;
  constexpr std::uint64_t kSeed = 1;
  std::mt19937_64 random(kSeed);
  std::optional<Eigen::Vector3d> best;
  std::size_t num_best = 2;
  for (int draw = 0; draw < kDraws; ++draw) {
    PlaneEquations equations;
    for (int k = 0; k < 3; ++k) {
      const std::size_t i = random() % points.rays.size();
      equations.add(points.rays[i], points.depths[i]);
    }
    const auto inverse_normal = equations.solve();
    const std::size_t num = inverse_normal ? points.num_on(*inverse_normal) : 0;
    if (num <= num_best) continue;
    best = inverse_normal;
    num_best = num;
  }
  return best;
}

}  // namespace

std::optional<FittedPlane> fit_plane(const std::vector<Eigen::Vector3d>& unit_rays, const std::vector<double>& depths,
                                     double max_relative_error) {
  if (unit_rays.size() < 3) return std::nullopt;
  const PointsAndPlane points{unit_rays, depths, max_relative_error};
  auto inverse_normal = drawn_plane(points);
  constexpr int kRounds = 5;
  PlaneEquations equations;
  for (int round = 0; inverse_normal && round < kRounds; ++round) {
    equations = {};
    for (std::size_t i = 0; i < unit_rays.size(); ++i) {
      if (points.is_on(*inverse_normal, i)) equations.add(unit_rays[i], depths[i]);
    }
    inverse_normal = equations.solve();
  }
  if (!inverse_normal) return std::nullopt;
  FittedPlane plane{*inverse_normal, {}, points.num_on(*inverse_normal)};
  double squares = 0;
  for (std::size_t i = 0; i < unit_rays.size(); ++i) {
    if (points.is_on(*inverse_normal, i)) squares += std::pow(relative_offset(*inverse_normal, unit_rays[i], depths[i]), 2);
  }
  const double variance = squares / std::max(1.0, static_cast<double>(plane.num_points) - 3.0);
  plane.covariance = variance * equations.matrix.ldlt().solve(Eigen::Matrix3d::Identity());
  return plane;
}

std::optional<Scale> estimate_plane_scale(const View& query, const View& match, const std::vector<Match>& matches,
                                          const Pose& match_from_query, const PlaneScaleOptions& options) {
  if (!query.height_above_ground && !match.height_above_ground) return std::nullopt;
  const MatchPoints points = match_points(query, match, matches, match_from_query, options.min_parallax_rad);
  if (static_cast<int>(points.rays.size()) < options.min_points) return std::nullopt;
  const auto plane = fit_plane(points.rays, points.depths, options.max_relative_error);
  if (!plane) return std::nullopt;
  Scale scale;
  scale.num_points = static_cast<int>(plane->num_points);
  scale.share = static_cast<double>(plane->num_points) / static_cast<double>(points.rays.size());
  if (scale.num_points < options.min_points || scale.share < options.min_share) return std::nullopt;

  // Both cameras are on the same side of the ground: of the query's centre t, 1 - n . t is its distance in units of the match's.
  const double match_distance = plane->distance();
  const double query_distance = match_distance * (1.0 - plane->inverse_normal.dot(match_from_query.translation));
  if (query_distance <= 0) return std::nullopt;
  std::vector<double> log_baselines;
  if (match.height_above_ground) log_baselines.push_back(std::log(*match.height_above_ground / match_distance));
  if (query.height_above_ground) log_baselines.push_back(std::log(*query.height_above_ground / query_distance));
  const double fit_sigma =
      std::sqrt(plane->inverse_normal.dot(plane->covariance * plane->inverse_normal)) / plane->inverse_normal.squaredNorm();
  constexpr double kSigmas = 4.0;
  scale.agrees = std::abs(log_baselines.front() - log_baselines.back()) <
                 kSigmas * std::hypot(fit_sigma, std::sqrt(2.0) * options.height_sigma);
  scale.baseline = std::exp(0.5 * (log_baselines.front() + log_baselines.back()));
  scale.relative_sigma = std::hypot(fit_sigma, options.height_sigma / std::sqrt(static_cast<double>(log_baselines.size())));
  scale.median_depth = scale.baseline * median(points.depths);
  return scale;
}

}  // namespace fabloop
