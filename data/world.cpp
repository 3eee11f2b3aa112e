// SPDX-License-Identifier: BSD-3-Clause
#include "data/world.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fabloop {
namespace {

/// How exactly the place where a ray meets the heights is found, metres along it.
constexpr double kHitTolerance = 1e-4;

/// A ray in the map's own units: columns, rows, metres of height, as functions of the distance along it.
struct MapRay {
  double column, row, height;
  double column_step, row_step, height_step;  ///< Per metre of distance.
};

MapRay in_map(const HeightMap& map, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  return {(origin.x() - map.origin.x()) / map.spacing_m,
          (origin.y() - map.origin.y()) / map.spacing_m,
          origin.z(),
          direction.x() / map.spacing_m,
          direction.y() / map.spacing_m,
          direction.z()};
}

double height_at_cell(const HeightMap& map, double column, double row) {
  const double c = std::clamp(column, 0.0, map.heights.cols - 1.001);
  const double r = std::clamp(row, 0.0, map.heights.rows - 1.001);
  const int ic = static_cast<int>(c);
  const int ir = static_cast<int>(r);
  const double fc = c - ic;
  const double fr = r - ir;
  const float* below = map.heights[ir] + ic;
  const float* above = map.heights[ir + 1] + ic;
  const double a = below[0] + (below[1] - below[0]) * fc;
  const double b = above[0] + (above[1] - above[0]) * fc;
  return a + (b - a) * fr;
}

double clearance(const HeightMap& map, const MapRay& ray, double distance) {
  return ray.height + distance * ray.height_step -
         height_at_cell(map, ray.column + distance * ray.column_step, ray.row + distance * ray.row_step);
}

/// Distance at which the ray leaves the block that it is in at `distance`.
double block_exit(const MapRay& ray, double distance, int block_column, int block_row) {
  const auto crossing = [&](double start, double step, int block) {
    if (std::abs(step) < 1e-12) return 1e30;
    const double edge = (step > 0 ? block + 1 : block) * static_cast<double>(HeightMap::kBlock);
    return (edge - start) / step;
  };
  // The small addition puts the next query inside the next block whatever the rounding.
  return std::max(distance,
                  std::min(crossing(ray.column, ray.column_step, block_column), crossing(ray.row, ray.row_step, block_row))) +
         1e-6;
}

/// First distance in [from, to] at which the ray is at or below the heights, or none.
std::optional<double> march(const HeightMap& map, const MapRay& ray, double from, double to) {
  const double sideways_cells = std::hypot(ray.column_step, ray.row_step);
  // At most one cell sideways and a few cells' height down, so that no canopy is stepped through.
  const double step = 1.0 / std::max({sideways_cells, -ray.height_step / (3.0 * map.spacing_m)});
  double above = from;
  for (double distance = from;; distance = std::min(distance + step, to)) {
    if (clearance(map, ray, distance) <= 0) {
      double below = distance;
      while (below - above > kHitTolerance) {
        const double middle = 0.5 * (above + below);
        (clearance(map, ray, middle) > 0 ? above : below) = middle;
      }
      return below;
    }
    above = distance;
    if (distance >= to) return std::nullopt;
  }
}

}  // namespace

void update_block_max(HeightMap& map) {
  const int rows = (map.heights.rows + HeightMap::kBlock - 1) / HeightMap::kBlock;
  const int cols = (map.heights.cols + HeightMap::kBlock - 1) / HeightMap::kBlock;
  map.block_max.create(rows, cols);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      // One more sample on the far sides: the last cell reaches to it.
      const cv::Range r(row * HeightMap::kBlock, std::min((row + 1) * HeightMap::kBlock + 1, map.heights.rows));
      const cv::Range c(col * HeightMap::kBlock, std::min((col + 1) * HeightMap::kBlock + 1, map.heights.cols));
      double largest = 0;
      cv::minMaxLoc(map.heights(r, c), nullptr, &largest);
      map.block_max(row, col) = static_cast<float>(largest);
    }
  }
  cv::minMaxLoc(map.block_max, nullptr, &map.max_height);
}

double height_at(const HeightMap& map, double x, double y) {
  return height_at_cell(map, (x - map.origin.x()) / map.spacing_m, (y - map.origin.y()) / map.spacing_m);
}

std::optional<double> intersect(const HeightMap& map, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  if (!(direction.z() < -1e-3)) return std::nullopt;
  const MapRay ray = in_map(map, origin, direction);
  if (clearance(map, ray, 0.0) <= 0) return std::nullopt;
  // Two levels: whole blocks are skipped while the ray stays above their largest height.
  double distance = std::max(0.0, (map.max_height - ray.height) / ray.height_step - 1e-6);
  while (true) {
    const int last_col = map.block_max.cols - 1;
    const int last_row = map.block_max.rows - 1;
    const auto block = [](double cells) { return static_cast<int>(std::floor(cells / HeightMap::kBlock)); };
    const int col = block(ray.column + distance * ray.column_step);
    const int row = block(ray.row + distance * ray.row_step);
    const double largest = map.block_max(std::clamp(row, 0, last_row), std::clamp(col, 0, last_col));
    const double exit = block_exit(ray, distance, col, row);
    const double descent = (largest - ray.height) / ray.height_step;  // where the ray sinks to the block's largest height
    if (descent < exit) {
      if (const auto hit = march(map, ray, std::max(distance, descent - 1e-6), exit)) return hit;
    }
    distance = exit;
  }
}

void update_texture_levels(World& world) {
  constexpr int kNumLevels = 4;
  world.texture.resize(1);
  for (int level = 1; level < kNumLevels; ++level) {
    cv::Mat3b half;
    cv::pyrDown(world.texture.back(), half);
    world.texture.push_back(half);
  }
}

}  // namespace fabloop
