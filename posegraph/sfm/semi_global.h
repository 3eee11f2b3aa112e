// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace fabloop {

/// A cost for each cell and each of a few ordered choices (heights).
class CostVolume {
 public:
  CostVolume(int rows, int columns, int choices, float value = 0)
      : rows_(rows), columns_(columns), choices_(choices), costs_(static_cast<std::size_t>(rows) * columns * choices, value) {}

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  int choices() const { return choices_; }
  float* at(int row, int column) { return &costs_[offset(row, column)]; }
  const float* at(int row, int column) const { return &costs_[offset(row, column)]; }

 private:
  std::size_t offset(int row, int column) const { return (static_cast<std::size_t>(row) * columns_ + column) * choices_; }

  int rows_, columns_, choices_;
  std::vector<float> costs_;
};

/// Sums over eight directions of the cheapest paths that end at a cell with a choice; a step to the next choice between
/// neighbours costs `small_step`, a larger one `large_step` (Hirschmueller, PAMI 2008, eq. 13 and 14).
CostVolume semi_global_sums(const CostVolume& costs, float small_step, float large_step);

/// The cheapest choice of a cell; of equal ones the first.
int cheapest(const CostVolume& costs, int row, int column);

/// Where between its neighbours the minimum at `choice` lies, in [-0.5, 0.5] (a parabola through three costs); 0 at the ends.
double refinement(const CostVolume& costs, int row, int column, int choice);

}  // namespace fabloop
