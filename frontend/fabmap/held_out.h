// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "frontend/fabmap/chow_liu_training.h"
#include "frontend/fabmap/chow_liu_tree.h"
#include "frontend/fabmap/observation.h"

namespace fabloop {

/// Some of the training images, and what is known without them.
struct HeldOut {
  std::vector<Observation> images;
  ChowLiuTree tree;  ///< Trained on the other images.
};

/// The images are cut into 20 blocks in their order; every fifth block is held out. Blocks, since neighbours in time see the
/// same. (The words themselves were made of all images.) None for fewer than ten images.
std::optional<HeldOut> hold_out(const std::vector<Observation>& observations, std::size_t num_words,
                                const ChowLiuOptions& options = {});

}  // namespace fabloop
