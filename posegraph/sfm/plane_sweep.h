// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frontend/progress.h"
#include "posegraph/sfm/ground_view.h"
#include "posegraph/sfm/height_field.h"
#include "posegraph/sfm/image_cache.h"

namespace fabloop {

/// How heights are found from the images.
struct PlaneSweepOptions {
  int max_views = 6;              ///< Views compared at a place. More: slower, and less troubled by what hides.
  int window = 7;                 ///< Cells across that are compared, odd. More: smoother, and less detail.
  float small_step_cost = 0.06F;  ///< For one height step between neighbours, in units of 1 - NCC. More: flatter.
  float large_step_cost = 0.35F;  ///< For a jump. More: edges of roofs are drawn out.
  float base_trust =
      0.15F;            ///< Cost at the ends of the range where two views compare (a tenth for more): heights stay near the base.
  int num_threads = 0;  ///< 0: all. Heights do not depend on it.
  Progress progress;
};

/// Heights near `base` at which the images agree: for each cell, heights within `range` of the base's in steps of `step` are
/// tried; for each, the views are laid onto the surface and compared by normalised cross-correlation over a window (the mean of
/// the better pairs, so that a view in which something is hidden does not count), and the costs are made smooth by semi-global
/// matching (Hirschmueller 2008) over eight directions. Confidence grows from 0 at NCC 0.3 to 1 at 0.7, and is less where fewer
/// than three views compare; what is not certain gives way to its surroundings. `level`: which half of the images fits the grid's
/// cells.
HeightField plane_sweep(const HeightField& base, const std::vector<GroundView>& views, ImageCache& images, double range,
                        double step, int level, double flying_height, const PlaneSweepOptions& options = {});

}  // namespace fabloop
