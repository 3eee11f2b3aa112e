// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/surface_mesh.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace fabloop {
namespace {

/// Every how many cells one is taken for at most `most` of them.
int stride_for(const cv::Mat1f& heights, std::size_t most) {
  const double ratio = static_cast<double>(heights.total()) / static_cast<double>(std::max<std::size_t>(1, most));
  return std::max(1, static_cast<int>(std::ceil(std::sqrt(ratio))));
}

/// Position on the picture (column, row) where it shows this place.
std::optional<Eigen::Vector2d> shown_at(const GroundPicture& picture, const Eigen::Vector2d& x_in_ground) {
  const Eigen::Vector2d at = picture.grid.position_of(x_in_ground);
  const auto column = static_cast<int>(std::lround(at.x()));
  const auto row = static_cast<int>(std::lround(at.y()));
  if (row < 0 || column < 0 || row >= picture.shown.rows || column >= picture.shown.cols) return std::nullopt;
  return picture.shown(row, column) != 0 ? std::optional(at) : std::nullopt;
}

ColouredPoint point_at(const GroundPicture& picture, const Eigen::Vector2d& at, const Eigen::Vector3d& x_in_ground,
                       const Pose& world_from_ground) {
  const cv::Vec3b& bgr = picture.colour(static_cast<int>(std::lround(at.y())), static_cast<int>(std::lround(at.x())));
  return {world_from_ground * x_in_ground, {bgr[2], bgr[1], bgr[0]}};
}

void add_triangles(const std::vector<std::int64_t>& upper, const std::vector<std::int64_t>& lower, SurfaceMesh& mesh) {
  const auto add = [&](std::int64_t a, std::int64_t b, std::int64_t c) {
    if (a < 0 || b < 0 || c < 0) return;
    mesh.triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)});
  };
  for (std::size_t j = 0; j + 1 < upper.size(); ++j) {
    add(upper[j], lower[j], upper[j + 1]);
    add(upper[j + 1], lower[j], lower[j + 1]);
  }
}

}  // namespace

SurfaceMesh mesh_of(const HeightField& surface, const GroundPicture& picture, const Pose& world_from_ground,
                    std::size_t max_vertices) {
  const int stride = stride_for(surface.heights, max_vertices);
  SurfaceMesh mesh;
  std::vector<std::int64_t> upper;
  for (int row = 0; row < surface.heights.rows; row += stride) {
    std::vector<std::int64_t> lower;
    for (int column = 0; column < surface.heights.cols; column += stride) {
      const Eigen::Vector2d x = surface.grid.ground_at(column, row);
      const auto at = shown_at(picture, x);
      lower.push_back(at ? static_cast<std::int64_t>(mesh.vertices.size()) : -1);
      if (!at) continue;
      mesh.vertices.push_back(point_at(picture, *at, {x.x(), x.y(), surface.heights(row, column)}, world_from_ground));
      mesh.texture_at.emplace_back((at->x() + 0.5) / picture.colour.cols, 1 - (at->y() + 0.5) / picture.colour.rows);
    }
    if (!upper.empty()) add_triangles(upper, lower, mesh);
    upper = std::move(lower);
  }
  return mesh;
}

std::vector<ColouredPoint> dense_points(const HeightField& surface, const GroundPicture& picture, const Pose& world_from_ground,
                                        std::size_t max_points) {
  constexpr float kSure = 0.25F;
  const int stride = stride_for(surface.heights, max_points);
  std::vector<ColouredPoint> points;
  for (int row = 0; row < surface.heights.rows; row += stride) {
    for (int column = 0; column < surface.heights.cols; column += stride) {
      if (surface.confidence(row, column) < kSure) continue;
      const Eigen::Vector2d x = surface.grid.ground_at(column, row);
      const auto at = shown_at(picture, x);
      if (at) points.push_back(point_at(picture, *at, {x.x(), x.y(), surface.heights(row, column)}, world_from_ground));
    }
  }
  return points;
}

}  // namespace fabloop
