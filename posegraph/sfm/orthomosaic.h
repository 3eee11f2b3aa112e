// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "frontend/progress.h"
#include "posegraph/sfm/exposure.h"
#include "posegraph/sfm/ground_view.h"
#include "posegraph/sfm/height_field.h"
#include "posegraph/sfm/image_cache.h"
#include "posegraph/sfm/seams.h"

namespace fabloop {

struct OrthomosaicOptions {
  /// Ground shown by fewer views is left out, but for holes inside of the rest, and so are tongues and islands narrower than a
  /// twentieth of the flying height. With one view heights are guesses.
  int min_views = 2;
  /// Views farther aslant than this do not count for it: heights are poor there, so that roads and roofs come out wavy, and what
  /// stands up hides what is behind.
  double max_slant_deg = 40;
  int num_bands = 4;  ///< Of multiband blending: seams are blended over up to 2^num_bands pixels.
  SeamOptions seams;
  int num_threads = 0;  ///< 0: all. The mosaic does not depend on it.
  Progress progress;
};

/// How well neighbouring views lie on each other where the mosaic changes from one to the other.
struct SeamResidual {
  double median_px = 0;  ///< Mosaic pixels by which patches of the two views are displaced against each other.
  double p90_px = 0;
  std::size_t num_places = 0;  ///< Places along seams where that could be measured.
};

/// The ground as seen from straight above.
struct Orthomosaic {
  GroundGrid grid;
  cv::Mat3b colour;  ///< BGR.
  cv::Mat1b shown;   ///< 255 where there is a picture, else 0.
  SeamResidual residual;
};

/// Lays the images onto the surface: every place from the view that shows it best (from above, near, not at the border, not
/// hidden by what stands in the way), exposures made equal, seams led where views agree and blended in bands of frequency (Burt &
/// Adelson 1983). `camera_of`: index of each view's camera among `num_cameras`.
Orthomosaic make_orthomosaic(const GroundGrid& grid, const HeightField& surface, const std::vector<GroundView>& views,
                             const std::vector<std::size_t>& camera_of, std::size_t num_cameras, ImageCache& images,
                             double flying_height, const OrthomosaicOptions& options = {});

}  // namespace fabloop
