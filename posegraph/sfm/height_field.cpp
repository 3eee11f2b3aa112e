// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/height_field.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fabloop {
namespace {

float bilinear(const cv::Mat1f& values, double column, double row) {
  const double x = std::clamp(column, 0.0, values.cols - 1.0);
  const double y = std::clamp(row, 0.0, values.rows - 1.0);
  const int x0 = std::min(static_cast<int>(x), std::max(0, values.cols - 2));
  const int y0 = std::min(static_cast<int>(y), std::max(0, values.rows - 2));
  const int x1 = std::min(x0 + 1, values.cols - 1);
  const int y1 = std::min(y0 + 1, values.rows - 1);
  const auto fx = static_cast<float>(x - x0);
  const auto fy = static_cast<float>(y - y0);
  const float upper = values(y0, x0) + fx * (values(y0, x1) - values(y0, x0));
  const float lower = values(y1, x0) + fx * (values(y1, x1) - values(y1, x0));
  return upper + fy * (lower - upper);
}

/// Sums of 2 x 2 cells; a last odd row or column stands alone.
cv::Mat1f pairwise_sums(const cv::Mat1f& values) {
  cv::Mat1f sums((values.rows + 1) / 2, (values.cols + 1) / 2, 0.0F);
  for (int row = 0; row < values.rows; ++row) {
    for (int column = 0; column < values.cols; ++column) sums(row / 2, column / 2) += values(row, column);
  }
  return sums;
}

}  // namespace

double height_at(const HeightField& field, const Eigen::Vector2d& x_in_ground) {
  const Eigen::Vector2d at = field.grid.position_of(x_in_ground);
  return bilinear(field.heights, at.x(), at.y());
}

HeightField resampled(const HeightField& field, const GroundGrid& grid) {
  HeightField result{grid, cv::Mat1f(grid.rows, grid.columns), cv::Mat1f(grid.rows, grid.columns)};
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const Eigen::Vector2d at = field.grid.position_of(grid.ground_at(column, row));
      result.heights(row, column) = bilinear(field.heights, at.x(), at.y());
      result.confidence(row, column) = bilinear(field.confidence, at.x(), at.y());
    }
  }
  return result;
}

cv::Mat1f fill_smoothly(const cv::Mat1f& values, const cv::Mat1f& weights) {
  if (values.rows == 1 && values.cols == 1) return values.clone();
  cv::Mat1f weighted(values.size(), 0.0F);
  for (int row = 0; row < values.rows; ++row) {
    for (int column = 0; column < values.cols; ++column) {
      const float weight = weights(row, column);
      if (weight > 0) weighted(row, column) = weight * values(row, column);
    }
  }
  const cv::Mat1f value_sums = pairwise_sums(weighted);
  cv::Mat1f coarse_weights = pairwise_sums(weights);
  cv::Mat1f coarse(value_sums.size(), 0.0F);
  for (int row = 0; row < coarse.rows; ++row) {
    for (int column = 0; column < coarse.cols; ++column) {
      const float weight = coarse_weights(row, column);
      if (weight > 0) coarse(row, column) = value_sums(row, column) / weight;
      coarse_weights(row, column) = std::min(1.0F, weight);
    }
  }
  const cv::Mat1f base = fill_smoothly(coarse, coarse_weights);
  cv::Mat1f filled(values.size());
  for (int row = 0; row < values.rows; ++row) {
    for (int column = 0; column < values.cols; ++column) {
      const float weight = weights(row, column);
      const float below = bilinear(base, 0.5 * column - 0.25, 0.5 * row - 0.25);
      filled(row, column) = weight > 0 ? weight * values(row, column) + (1 - weight) * below : below;
    }
  }
  return filled;
}

bool is_visible(const HeightField& field, double highest, const Eigen::Vector3d& point, const Eigen::Vector3d& centre,
                double tolerance) {
  const Eigen::Vector3d way = centre - point;
  if (!(way.z() > 0)) return false;
  const double along = std::min(1.0, (highest - point.z()) / way.z());  // above the highest place nothing is in the way
  if (along <= 0) return true;
  const double length = along * way.head<2>().norm();
  constexpr double kPerCell = 2;  // an edge one cell wide must not slip through
  const int steps = static_cast<int>(std::ceil(kPerCell * length / field.grid.spacing));
  for (int step = 1; step <= steps; ++step) {
    const Eigen::Vector3d x = point + (along * step / steps) * way;
    if (height_at(field, x.head<2>()) > x.z() + tolerance) return false;
  }
  return true;
}

}  // namespace fabloop
