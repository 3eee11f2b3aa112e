// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

namespace fabloop {

/// Coordinates in which a few numbers bound the distance of rows from below: those along the K directions in which the rows
/// vary most, and the length of all that is left. For orthonormal directions P and remainders r,
/// |x - y|^2 = |P x - P y|^2 + |r_x - r_y|^2 >= |P x - P y|^2 + (|r_x| - |r_y|)^2.
class RowProjection {
 public:
  /// From some of `rows` (W x D, CV_32F): so many directions as hold most of their variance, a multiple of eight less two.
  explicit RowProjection(const cv::Mat& rows);

  /// K: directions. As many as the rows have columns where fewer would not do.
  std::size_t num_directions() const { return num_directions_; }

  /// Coordinates of one row: K along the directions, then the length of the remainder. Their errors by rounding stay below
  /// 2^-22 of the row's distance from the mean, which is returned. `coordinates` has room for K + 1.
  double project(const float* row, float* coordinates) const;

 private:
  std::size_t dimension_ = 0;
  std::size_t num_directions_ = 0;
  std::vector<double> mean_;
  std::vector<double> directions_;  ///< D x (K + 2); the last two are zero, which makes a multiple of eight.
};

}  // namespace fabloop
