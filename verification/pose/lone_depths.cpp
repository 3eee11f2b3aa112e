// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/lone_depths.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "verification/median.h"
#include "verification/pose/plane_scale.h"
#include "verification/pose/residuals.h"

namespace fabloop {
namespace {

/// An inlier as a point.
struct InlierPoint {
  std::size_t pair = 0;
  Eigen::Vector3d ray;      ///< Of the match.
  double log_offset = 0;    ///< Logarithm of its depth over that of the plane along its ray.
  double log_depth_by_rad;  ///< How its logarithmic depth grows with a shift along the epipolar line: the parallax's cotangent.
};

std::vector<InlierPoint> inlier_points(std::span<const RayPair> pairs, const RelativePose& relative, double max_plane_error) {
  std::vector<InlierPoint> points;
  std::vector<Eigen::Vector3d> rays;
  std::vector<double> depths;
  for (const std::size_t i : relative.inliers) {
    const Eigen::Vector3d query_ray = relative.match_from_query.rotation * pairs[i].query;
    const RayDepths found = ray_depths(query_ray, pairs[i].match, relative.match_from_query.translation);
    if (found.squared_sine <= 0 || found.match <= 0) continue;
    const double cotangent = std::abs(query_ray.dot(pairs[i].match)) / std::sqrt(found.squared_sine);
    points.push_back({i, pairs[i].match, 0, cotangent});
    rays.push_back(pairs[i].match);
    depths.push_back(found.match / found.squared_sine);
  }
  const auto plane = fit_plane(rays, depths, max_plane_error);
  const double usual_depth = median(depths);
  constexpr double kMinRatio = 1e-3;  // behind the plane's horizon
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double ratio = plane ? plane->inverse_normal.dot(rays[i]) * depths[i] : depths[i] / usual_depth;
    points[i].log_offset = std::log(std::max(ratio, kMinRatio));
  }
  return points;
}

/// Cauchy's: depths of a scene have heavy tails.
double cauchy_density(double value, double scale) {
  const double x = value / scale;
  return 1.0 / (std::numbers::pi * scale * (1.0 + x * x));
}

/// Mean density of a point's offset about those of its nearest neighbours by their rays.
double density_among_neighbours(const std::vector<InlierPoint>& points, const InlierPoint& point, double scale,
                                std::size_t num_neighbours) {
  std::vector<std::pair<double, double>> others;  // cosine of the angle (negative: nearest first), offset
  for (const InlierPoint& other : points) {
    if (other.pair != point.pair) others.emplace_back(-other.ray.dot(point.ray), other.log_offset);
  }
  const std::size_t count = std::min(num_neighbours, others.size());
  if (count == 0) return 0;
  std::partial_sort(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(count), others.end());
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += cauchy_density(point.log_offset - others[i].second, scale);
  return sum / static_cast<double>(count);
}

}  // namespace

std::vector<std::size_t> lone_depths(std::span<const RayPair> pairs, const RelativePose& relative, double max_error_rad,
                                     const LoneDepthOptions& options) {
  const std::vector<InlierPoint> points = inlier_points(pairs, relative, options.max_plane_error);
  std::vector<double> offsets;
  for (const InlierPoint& point : points) offsets.push_back(std::abs(point.log_offset));
  constexpr double kSigmaOfMedian = 1.4826;
  const double relief = std::max(options.min_relief, kSigmaOfMedian * median(std::move(offsets)));
  std::vector<std::size_t> lone;
  for (const InlierPoint& point : points) {
    const double scale = std::hypot(relief, max_error_rad * point.log_depth_by_rad);
    // Of a true one's offset, half by the plane and half by the neighbours; along the line it is a density a radian.
    const double of_plane = 0.5 * cauchy_density(point.log_offset, scale);
    const double least = options.min_likelihood_ratio / (options.line_length_rad * point.log_depth_by_rad);
    if (of_plane >= least) continue;
    if (of_plane + 0.5 * density_among_neighbours(points, point, scale, options.num_neighbours) < least)
      lone.push_back(point.pair);
  }
  return lone;
}

std::optional<BendingAccidents> find_bending_accidents(std::span<const RayPair> pairs, const RelativePose& relative,
                                                       const RelativePoseOptions& pose_options, const LoneDepthOptions& options) {
  std::vector<std::size_t> lone = lone_depths(pairs, relative, pose_options.max_error_rad, options);
  if (lone.empty()) return std::nullopt;
  std::vector<RayPair> others;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!std::binary_search(lone.begin(), lone.end(), i)) others.push_back(pairs[i]);
  }
  const auto of_others = refine_relative_pose(others, relative.match_from_query, pose_options);
  if (!of_others) return std::nullopt;
  const Eigen::Matrix3d essential = essential_matrix(of_others->match_from_query);
  std::erase_if(lone, [&](std::size_t i) {
    return std::abs(epipolar_residual(pairs[i].query, pairs[i].match, essential).angle()) < pose_options.max_error_rad;
  });
  if (lone.empty()) return std::nullopt;
  return BendingAccidents{std::move(lone), of_others->match_from_query};
}

}  // namespace fabloop
