// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/row_search.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "frontend/fabmap/cluster_means.h"
#include "frontend/features/dot_products.h"

namespace fabloop {
namespace {

constexpr int kMinRowsForCells = 256;
constexpr double kCellsPerRootOfRows = 1.28;

}  // namespace

RowSearch::RowSearch(const cv::Mat& rows, RowSearchKind kind) : rows_(rows) {
  assert(rows.rows > 0 && rows.type() == CV_32FC1 && rows.isContinuous());
  if (kind == RowSearchKind::ManyTimes && rows.rows >= kMinRowsForCells) {
    projection_.emplace(rows);
    if (projection_->num_directions() == static_cast<std::size_t>(rows.cols)) projection_.reset();
  }
  num_coordinates_ = (projection_ ? projection_->num_directions() + 1 : static_cast<std::size_t>(rows.cols)) + 1;
  std::vector<float> coordinates(static_cast<std::size_t>(rows.rows) * num_coordinates_);
  for (int row = 0; row < rows.rows; ++row) {
    float* of_row = coordinates.data() + static_cast<std::size_t>(row) * num_coordinates_;
    if (projection_) {
      projection_->project(rows.ptr<float>(row), of_row);
    } else {
      std::copy_n(rows.ptr<float>(row), rows.cols, of_row);
    }
    max_norm_ = std::max(max_norm_, static_cast<float>(std::sqrt(append_squared_norm({of_row, num_coordinates_}))));
  }
  if (projection_) {
    make_cells(coordinates);
    return;
  }
  std::vector<std::uint32_t> all(static_cast<std::size_t>(rows.rows));
  std::iota(all.begin(), all.end(), 0u);
  add_panels(all, coordinates);
}

std::size_t RowSearch::num_panels() const { return rows_of_slots_.size() / kPanelWidth; }

/// Lays rows out in panels of their own.
void RowSearch::add_panels(std::span<const std::uint32_t> rows, const std::vector<float>& coordinates) {
  for (std::size_t begin = 0; begin < rows.size(); begin += kPanelWidth) {
    const std::size_t panel = panels_.size();
    panels_.resize(panel + num_coordinates_ * kPanelWidth, 0.0F);
    for (std::size_t column = 0; column < kPanelWidth; ++column) {
      const bool filled = begin + column < rows.size();
      rows_of_slots_.push_back(filled ? rows[begin + column] : kNoRow);
      float* target = panels_.data() + panel + column;
      if (!filled) target[(num_coordinates_ - 1) * kPanelWidth] = std::numeric_limits<float>::max();
      for (std::size_t d = 0; filled && d < num_coordinates_; ++d) {
        target[d * kPanelWidth] = coordinates[rows[begin + column] * num_coordinates_ + d];
      }
    }
  }
}

/// Sorts the rows into cells around centres (k-means, from rows at equal steps).
void RowSearch::make_cells(const std::vector<float>& coordinates) {
  constexpr int kIterations = 6;
  const int width = static_cast<int>(num_coordinates_) - 1;
  const int num_cells = static_cast<int>(kCellsPerRootOfRows * std::sqrt(static_cast<double>(rows_.rows)));
  cv::Mat points(rows_.rows, width, CV_32F), centres(num_cells, width, CV_32F);
  for (int row = 0; row < rows_.rows; ++row) {
    std::copy_n(coordinates.data() + static_cast<std::size_t>(row) * num_coordinates_, width, points.ptr<float>(row));
  }
  for (int cell = 0; cell < num_cells; ++cell) {
    points.row(static_cast<int>(static_cast<std::int64_t>(cell) * rows_.rows / num_cells)).copyTo(centres.row(cell));
  }
  std::vector<std::uint32_t> cell_of_row;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    if (iteration > 0) move_to_means(centres, points, cell_of_row, 1);
    cell_of_row = RowSearch(centres, RowSearchKind::Once).nearest(points, 1).row;
  }
  std::vector<std::vector<std::uint32_t>> members(static_cast<std::size_t>(num_cells));
  for (std::uint32_t row = 0; row < cell_of_row.size(); ++row) members[cell_of_row[row]].push_back(row);
  for (const auto& cell : members) {
    const std::size_t begin = num_panels();
    add_panels(cell, coordinates);
    cells_.push_back({begin, num_panels()});
  }
  cell_panels_ = RowSearch(centres, RowSearchKind::Once).panels_;
}

double RowSearch::append_squared_norm(std::span<float> coordinates) {
  double sum = 0.0;
  for (const float value : coordinates.first(coordinates.size() - 1)) {
    sum += static_cast<double>(value) * static_cast<double>(value);
  }
  coordinates.back() = static_cast<float>(sum);
  return sum;
}

}  // namespace fabloop
