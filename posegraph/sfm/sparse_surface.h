// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "posegraph/sfm/ground_view.h"
#include "posegraph/sfm/height_field.h"

namespace fabloop {

/// What the points alone say of the surface.
struct SparseSurface {
  HeightField field;             ///< Medians of cells, smooth where there are no points.
  double flying_height = 0;      ///< Median height of cameras above the surface.
  double ground_sampling = 0;    ///< Median width of a pixel on the ground.
  double relief = 0;             ///< What 98 in 100 points keep within, above or below the field.
  std::size_t num_outliers = 0;  ///< Points that disagree with their neighbours, left out.
};

/// A height field through points (ground frame) over what the views see of the ground. A point is left out where its height
/// differs from the median of its neighbours by more than 4 of their robust standard deviations (at least 2 %, at most 20 % of
/// the flying height). Throws InputError for fewer than 10 points, and where no view sees the ground.
SparseSurface sparse_surface(const std::vector<Eigen::Vector3d>& points, const std::vector<GroundView>& views);

}  // namespace fabloop
