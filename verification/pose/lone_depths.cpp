// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/lone_depths.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "verification/median.h"
#include "verification/pose/plane_scale.h"
#include "verification/pose/residuals.h"

namespace fabloop {
namespace {

/// An inlier as a point.
struct InlierPoint {
  std::size_t pair = 0;
  Eigen::Vector3d query_ray;  ///< In the match's axes.
  Eigen::Vector3d match_ray;
  double depth = 0;          ///< From the match, with a baseline of one.
  double sine = 0;           ///< Of the parallax.
  double log_offset = 0;     ///< Logarithm of its depth over that of the plane along its ray.
  double offset_by_rad = 0;  ///< How that grows as the match's ray moves along the epipolar line.
};

std::vector<InlierPoint> inlier_points(std::span<const RayPair> pairs, const RelativePose& relative) {
  std::vector<InlierPoint> points;
  for (const std::size_t i : relative.inliers) {
    const Eigen::Vector3d query_ray = relative.match_from_query.rotation * pairs[i].query;
    const RayDepths found = ray_depths(query_ray, pairs[i].match, relative.match_from_query.translation);
    if (found.squared_sine <= 0 || found.match <= 0) continue;
    points.push_back({i, query_ray, pairs[i].match, found.match / found.squared_sine, std::sqrt(found.squared_sine), 0, 0});
  }
  return points;
}

/// The plane that holds most of the points, where one does.
std::optional<FittedPlane> main_plane(const std::vector<InlierPoint>& points, const LoneDepthOptions& options) {
  std::vector<Eigen::Vector3d> rays;
  std::vector<double> depths;
  for (const InlierPoint& point : points) {
    rays.push_back(point.match_ray);
    depths.push_back(point.depth);
  }
  auto plane = fit_plane(rays, depths, options.max_plane_error);
  const bool holds =
      plane && static_cast<double>(plane->num_points) >= options.min_plane_share * static_cast<double>(points.size());
  return holds ? plane : std::nullopt;
}

/// Offsets from the main plane, or else from the median depth. Points whose rays do not meet the plane are left out.
///
/// As the match's ray moves along its epipolar line by da, the point x = d m moves along the query's ray r by d da /
/// sin(parallax), and n . x by n . r times that.
void state_offsets(std::vector<InlierPoint>& points, const LoneDepthOptions& options) {
  const auto plane = main_plane(points, options);
  std::vector<double> depths;
  for (const InlierPoint& point : points) depths.push_back(point.depth);
  const double usual_depth = median(std::move(depths));
  if (plane) std::erase_if(points, [&](const InlierPoint& point) { return plane->inverse_normal.dot(point.match_ray) <= 0; });
  for (InlierPoint& point : points) {
    const double per_depth = plane ? plane->inverse_normal.dot(point.match_ray) : 1.0 / usual_depth;
    const double turned = plane ? std::abs(plane->inverse_normal.dot(point.query_ray)) / per_depth : 1.0;
    point.log_offset = std::log(per_depth * point.depth);
    point.offset_by_rad = turned / point.sine;
  }
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
    if (other.pair != point.pair) others.emplace_back(-other.match_ray.dot(point.match_ray), other.log_offset);
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
  std::vector<InlierPoint> points = inlier_points(pairs, relative);
  state_offsets(points, options);
  std::vector<double> offsets;
  for (const InlierPoint& point : points) offsets.push_back(std::abs(point.log_offset));
  constexpr double kSigmaOfMedian = 1.4826;
  const double relief = std::max(options.min_relief, kSigmaOfMedian * median(std::move(offsets)));
  std::vector<std::size_t> lone;
  for (const InlierPoint& point : points) {
    const double scale = std::hypot(relief, max_error_rad * point.offset_by_rad);
    // Of a true one's offset, half by the plane and half by the neighbours; along the line it is a density a radian.
    const double of_plane = 0.5 * cauchy_density(point.log_offset, scale);
    // Depths that scatter as far as the line reaches tell nothing of what lies within their scatter.
    constexpr double kOfPeak = 0.1;
    const double accidental = options.min_likelihood_ratio / (options.line_length_rad * std::max(1e-9, point.offset_by_rad));
    const double least = std::min(accidental, kOfPeak * cauchy_density(0, scale));
    if (of_plane >= least) continue;
    if (of_plane + 0.5 * density_among_neighbours(points, point, scale, options.num_neighbours) < least)
      lone.push_back(point.pair);
  }
  if (static_cast<double>(lone.size()) > options.max_share * static_cast<double>(points.size())) lone.clear();
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
