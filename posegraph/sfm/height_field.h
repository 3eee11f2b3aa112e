// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "posegraph/sfm/ground_grid.h"

namespace fabloop {

/// One height for each place on the ground (frame: x, y along the ground, z up). A height belongs to a cell's centre; between
/// centres it is bilinear, beyond the border the border's heights go on.
struct HeightField {
  GroundGrid grid;
  cv::Mat1f heights;     ///< Rows x columns, finite everywhere.
  cv::Mat1f confidence;  ///< Rows x columns, in [0, 1]; 0: interpolated from elsewhere.
};

/// Height at ground x, y.
double height_at(const HeightField& field, const Eigen::Vector2d& x_in_ground);

/// The same heights, bilinear, on another grid; confidences too.
HeightField resampled(const HeightField& field, const GroundGrid& grid);

/// Fills cells of weight 0 smoothly from the others (the pull-push of Gortler et al. 1996, section 3.4.3): averages on coarser
/// and coarser grids, from which what is missing is interpolated. Cells of weight 1 keep their value, those between give way in
/// part. Weights in [0, 1]; at least one must not be 0.
cv::Mat1f fill_smoothly(const cv::Mat1f& values, const cv::Mat1f& weights);

/// Whether a point on the surface is seen from `centre` (ground frame): no height on the way rises above the line of sight by
/// more than `tolerance`. `highest` is the largest height of the field.
bool is_visible(const HeightField& field, double highest, const Eigen::Vector3d& point, const Eigen::Vector3d& centre,
                double tolerance);

}  // namespace fabloop
