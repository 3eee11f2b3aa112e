// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/semi_global.h"

#include <algorithm>
#include <array>

namespace fabloop {
namespace {

struct Direction {
  int row, column;
};

/// One direction's recursion (eq. 13) in an order in which the cell before has been visited; added to `sums`.
void add_paths(const CostVolume& costs, Direction from, float small_step, float large_step, CostVolume& paths, CostVolume& sums) {
  const int n = costs.choices();
  const bool rows_up = from.row > 0 || (from.row == 0 && from.column > 0);
  for (int i = 0; i < costs.rows(); ++i) {
    const int row = rows_up ? costs.rows() - 1 - i : i;
    for (int j = 0; j < costs.columns(); ++j) {
      const int column = from.column > 0 ? costs.columns() - 1 - j : j;
      const float* cost = costs.at(row, column);
      float* path = paths.at(row, column);
      float* sum = sums.at(row, column);
      const int r = row + from.row;
      const int c = column + from.column;
      if (r < 0 || c < 0 || r >= costs.rows() || c >= costs.columns()) {
        for (int d = 0; d < n; ++d) sum[d] += path[d] = cost[d];
        continue;
      }
      const float* before = paths.at(r, c);
      const float least = *std::min_element(before, before + n);
      for (int d = 0; d < n; ++d) {
        float cheapest = std::min(before[d], least + large_step);
        if (d > 0) cheapest = std::min(cheapest, before[d - 1] + small_step);
        if (d + 1 < n) cheapest = std::min(cheapest, before[d + 1] + small_step);
        path[d] = cost[d] + cheapest - least;
        sum[d] += path[d];
      }
    }
  }
}

}  // namespace

CostVolume semi_global_sums(const CostVolume& costs, float small_step, float large_step) {
  constexpr std::array<Direction, 8> kDirections{{{0, -1}, {0, 1}, {-1, 0}, {1, 0}, {-1, -1}, {1, 1}, {-1, 1}, {1, -1}}};
  CostVolume sums(costs.rows(), costs.columns(), costs.choices());
  CostVolume paths(costs.rows(), costs.columns(), costs.choices());
  for (const Direction& from : kDirections) add_paths(costs, from, small_step, large_step, paths, sums);
  return sums;
}

int cheapest(const CostVolume& costs, int row, int column) {
  const float* cost = costs.at(row, column);
  return static_cast<int>(std::min_element(cost, cost + costs.choices()) - cost);
}

double refinement(const CostVolume& costs, int row, int column, int choice) {
  if (choice == 0 || choice + 1 >= costs.choices()) return 0;
  const float* cost = costs.at(row, column);
  const double below = cost[choice - 1];
  const double above = cost[choice + 1];
  const double curvature = below + above - 2.0 * cost[choice];
  return curvature > 1e-9 ? std::clamp(0.5 * (below - above) / curvature, -0.5, 0.5) : 0.0;
}

}  // namespace fabloop
