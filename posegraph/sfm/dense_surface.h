// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posegraph/sfm/ground_view.h"
#include "posegraph/sfm/height_field.h"
#include "posegraph/sfm/image_cache.h"
#include "posegraph/sfm/plane_sweep.h"
#include "posegraph/sfm/sparse_surface.h"

namespace fabloop {

struct DenseSurfaceOptions {
  /// Finest cells: twice as wide as an image's pixels on the ground for 1, four times for 2, ... Each is four times quicker.
  int finest_level = 1;
  int coarsest_level = 3;              ///< Where the search over all of the range takes place.
  std::size_t max_cells = 16'000'000;  ///< The finest level with no more cells than that is the last.
  PlaneSweepOptions sweep;
};

/// The surface from sparse to dense: a plane sweep over the range that the points leave open on coarse cells, and narrower ones
/// about what was found on finer and finer cells.
HeightField dense_surface(const SparseSurface& sparse, const std::vector<GroundView>& views, ImageCache& images,
                          const DenseSurfaceOptions& options = {});

}  // namespace fabloop
