// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "posegraph/sfm/ground_view.h"
#include "posegraph/sfm/height_field.h"
#include "posegraph/sfm/image_cache.h"

namespace fabloop {

/// A view that shows a block of ground.
struct BlockView {
  std::uint32_t view = 0;  ///< Index into the views.
  float quality = 0;       ///< GroundView::quality(); a twentieth of it where something stands in the way.
  float radius = 0;        ///< Distance from the principal point, 1 at the farthest corner.
  cv::Vec3b colour;        ///< Mean over the block, BGR.
};

/// The ground in blocks of a few mosaic pixels, and for each the views that show it best, the best first.
struct MosaicBlocks {
  static constexpr int kSide = 8;      ///< Mosaic pixels across.
  static constexpr int kMaxViews = 6;  ///< Kept a block.

  GroundGrid grid;
  std::vector<BlockView> entries;         ///< kMaxViews a block, row by row.
  std::vector<std::uint8_t> num_views;    ///< Used entries of each block.
  std::vector<std::uint16_t> num_seeing;  ///< Views that show it not too far aslant, kept or not.

  std::span<const BlockView> at(std::size_t block) const { return {&entries[block * kMaxViews], num_views[block]}; }
  std::size_t size() const { return num_views.size(); }

  /// Bytes a block takes, for budgets.
  static constexpr std::size_t kBytes = kMaxViews * sizeof(BlockView) + sizeof(std::uint8_t) + sizeof(std::uint16_t);
};

/// Looks at every block of a mosaic's grid through every view. Rays farther than `max_slant_deg` from the vertical do not count
/// for `num_seeing`.
MosaicBlocks look_at_blocks(const GroundGrid& mosaic, const HeightField& surface, const std::vector<GroundView>& views,
                            ImageCache& images, double flying_height, double max_slant_deg, int num_threads);

/// Distance of a pixel from the principal point, 1 at the farthest corner of the image.
double image_radius(const Camera& camera, const Eigen::Vector2d& pixel);

/// The half of the images whose pixels are about as wide on the ground as `spacing`.
int pyramid_level(double spacing, double ground_sampling);

}  // namespace fabloop
