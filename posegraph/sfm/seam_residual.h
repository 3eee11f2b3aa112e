// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posegraph/sfm/orthomosaic.h"

namespace fabloop {

/// What a mosaic is made from.
struct MosaicScene {
  const GroundGrid& grid;
  const HeightField& surface;
  const std::vector<GroundView>& views;
  const std::vector<std::size_t>& camera_of;
  ImageCache& images;
  const MosaicBlocks& blocks;
  const Exposure& exposure;
  const Seams& seams;
  const cv::Mat1b& shown;          ///< 255 for blocks that the mosaic shows.
  const cv::Mat3f& drift_factors;  ///< Of blocks; see exposure.h.
};

/// Displacements of patches of the two views at places along seams, by phase correlation.
SeamResidual measure_seams(const MosaicScene& scene, int num_threads);

}  // namespace fabloop
