// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/ground_grid.h"

#include <algorithm>
#include <cmath>

namespace fabloop {

GroundGrid grid_over(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double spacing) {
  // A width of a whole number of cells must not get one more from rounding.
  constexpr double kRounding = 1e-9;
  const auto cells = [&](double width) { return std::max(1, static_cast<int>(std::ceil(width / spacing - kRounding))); };
  return {{low.x() + 0.5 * spacing, high.y() - 0.5 * spacing}, spacing, cells(high.y() - low.y()), cells(high.x() - low.x())};
}

GroundGrid coarser(const GroundGrid& grid, int factor) {
  const double half = 0.5 * grid.spacing;
  const Eigen::Vector2d north_west = grid.first_centre + Eigen::Vector2d(-half, half);
  const double spacing = grid.spacing * factor;
  return {north_west + Eigen::Vector2d(0.5 * spacing, -0.5 * spacing), spacing, (grid.rows + factor - 1) / factor,
          (grid.columns + factor - 1) / factor};
}

}  // namespace fabloop
