// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "frontend/fabmap/ground_truth.h"
#include "frontend/fabmap/precision_recall.h"
#include "frontend/recognition/recognition_run.h"

namespace fabloop {

/// A matrix made small enough to look at: each cell is the greatest of the square of entries that fall into it, so that single
/// peaks stay visible.
class MatrixThumbnail {
 public:
  MatrixThumbnail(std::size_t num_rows, std::size_t num_columns, std::size_t max_cells = 800);

  /// Row `index`, entries from the first column on. Those after its end, and NaN, have no value.
  void add_row(std::size_t index, std::span<const double> row);

  std::size_t num_rows() const { return num_rows_; }
  std::size_t num_columns() const { return num_columns_; }

  /// The cells, CV_64F, at most max_cells each way; NaN where no entry has a value.
  const cv::Mat& cells() const { return cells_; }

  /// Entries a cell, each way.
  std::size_t entries_a_cell() const { return step_; }

 private:
  std::size_t num_rows_;
  std::size_t num_columns_;
  std::size_t step_;
  cv::Mat cells_;
};

/// How the values of a matrix become colours.
struct ColourScale {
  double low = 0.0, high = 1.0;  ///< The ends of the colour bar; values beyond them have its end colours.
  std::string label;
};

/// A matrix of queries (rows, downwards) and places (columns) with axes and colour bar (BGR, 8 bit), under 2000 pixels wide. What
/// has no value is grey. `truth`, of the same shape, is put on its right.
struct MatrixPicture {
  std::string title;
  const MatrixThumbnail& values;
  ColourScale scale;
  const MatrixThumbnail* truth = nullptr;  ///< See truth_thumbnail.
};
cv::Mat draw_matrix(const MatrixPicture& picture);

/// log10 of the probabilities, from one in a million to one.
ColourScale probability_scale();

/// From zero (each row's median) to what one cell in a thousand exceeds.
ColourScale likelihood_scale(const MatrixThumbnail& values);

/// The entries less the median of those that are finite.
std::vector<double> above_median(std::span<const double> row);

/// The truth of each image and the places that there were: 2 true, 1 not judged, 0 false.
MatrixThumbnail truth_thumbnail(const Recognition& recognition, const GroundTruth& truth);

}  // namespace fabloop
