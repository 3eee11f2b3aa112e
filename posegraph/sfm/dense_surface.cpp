// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/dense_surface.h"

#include <algorithm>
#include <cmath>

namespace fabloop {
namespace {

/// How far from the sparse surface to search: beyond what the points show, as roofs and crowns have few; in parts of the flying
/// height.
double search_range(const SparseSurface& sparse) {
  constexpr double kBeyondPoints = 1.5;
  constexpr double kLeast = 0.04;
  constexpr double kMost = 0.3;
  return std::clamp(kBeyondPoints * sparse.relief, kLeast * sparse.flying_height, kMost * sparse.flying_height);
}

/// The same rectangle with other cells.
GroundGrid with_spacing(const GroundGrid& grid, double spacing) {
  const double half = 0.5 * grid.spacing;
  const Eigen::Vector2d north_west = grid.first_centre + Eigen::Vector2d(-half, half);
  const Eigen::Vector2d south_east = north_west + Eigen::Vector2d(grid.columns, -grid.rows) * grid.spacing;
  return grid_over({north_west.x(), south_east.y()}, {south_east.x(), north_west.y()}, spacing);
}

}  // namespace

HeightField dense_surface(const SparseSurface& sparse, const std::vector<GroundView>& views, ImageCache& images,
                          const DenseSurfaceOptions& options) {
  HeightField surface = sparse.field;
  double range = search_range(sparse);
  for (int level = options.coarsest_level; level >= options.finest_level; --level) {
    const double spacing = std::ldexp(sparse.ground_sampling, level);
    const GroundGrid grid = with_spacing(sparse.field.grid, spacing);
    const bool is_first = level == options.coarsest_level;
    if (!is_first && static_cast<std::size_t>(grid.rows) * grid.columns > options.max_cells) break;
    // Neighbouring views lie a third of the height apart or more, so that a step moves them by a third of a cell against each
    // other.
    constexpr double kStepsAboutCoarser = 4;
    surface = plane_sweep(resampled(surface, grid), views, images, range, spacing, level, sparse.flying_height, options.sweep);
    range = kStepsAboutCoarser * 0.5 * spacing;
  }
  return surface;
}

}  // namespace fabloop
