// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "posegraph/sfm/exposure.h"
#include "posegraph/sfm/mosaic_blocks.h"

namespace fabloop {

struct SeamOptions {
  double quality_weight =
      0.6;  ///< For taking a view that shows the block worse. More: each view's own middle; less: seams wander farther.
  double outlier_weight = 0.6;  ///< For a view in which the block has another colour than in most: a car, a bird.
  double colour_weight = 1.0;   ///< For a seam where the views' colours differ.
  double length_weight = 0.08;  ///< For any seam. More: shorter seams.
  int num_sweeps = 2;           ///< Over all views.
};

/// Which entry of MosaicBlocks a block is taken from; kNoView where no view shows it.
struct Seams {
  static constexpr std::uint8_t kNoView = 255;
  std::vector<std::uint8_t> choice;  ///< One a block: position within MosaicBlocks::at().

  /// The view a block is taken from, or -1.
  std::int64_t view_of(const MosaicBlocks& blocks, std::size_t block) const {
    return choice[block] == kNoView ? -1 : static_cast<std::int64_t>(blocks.at(block)[choice[block]].view);
  }
};

/// Chooses the view of every block such that seams run where views agree: minimises quality lost, colours unlike the others'
/// and what can be seen along seams (Agarwala et al. 2004, "Interactive Digital Photomontage"), by expansion moves (Boykov,
/// Veksler & Zabih 2001) view by view in their order. `camera_of` has one index a view.
Seams find_seams(const MosaicBlocks& blocks, const Exposure& exposure, const std::vector<std::size_t>& camera_of,
                 const SeamOptions& options = {});

}  // namespace fabloop
