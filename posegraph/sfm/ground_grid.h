// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace fabloop {

/// A raster over the ground plane as maps have it: row 0 is the northernmost (largest y), column 0 the westernmost (smallest x).
/// Positions on it are in cells, with cell centres at integers.
struct GroundGrid {
  Eigen::Vector2d first_centre = {0, 0};  ///< Ground x, y of the centre of cell (row 0, column 0).
  double spacing = 1;                     ///< Between neighbouring centres.
  int rows = 0;
  int columns = 0;

  /// Ground x, y of a position (column, row).
  Eigen::Vector2d ground_at(double column, double row) const {
    return {first_centre.x() + column * spacing, first_centre.y() - row * spacing};
  }

  /// The position (column, row) of ground x, y.
  Eigen::Vector2d position_of(const Eigen::Vector2d& x_in_ground) const {
    return {(x_in_ground.x() - first_centre.x()) / spacing, (first_centre.y() - x_in_ground.y()) / spacing};
  }
};

/// The grid of this spacing whose cells cover the rectangle from `low` to `high` (corners, not centres).
GroundGrid grid_over(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double spacing);

/// A grid over the same rectangle with cells `factor` times as wide.
GroundGrid coarser(const GroundGrid& grid, int factor);

}  // namespace fabloop
