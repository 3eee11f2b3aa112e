// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "frontend/fabmap/chow_liu_tree.h"
#include "frontend/fabmap/detector_model.h"
#include "frontend/fabmap/held_out.h"
#include "frontend/fabmap/observation.h"

namespace fabloop {

/// How a model does on the images that it was trained on: what training can tell of itself without any truth. The words were
/// made of all images, so every figure is an upper bound of what other images of the kind will give.
struct SelfTest {
  /// Does the tree help? Images that were held out (see hold_out) are judged by a tree trained on the others and by its naive
  /// Bayes model. Too few images for that: none held out.
  std::size_t num_held_out = 0;
  double tree_log_likelihood = 0.0;         ///< Mean log p(Z) of a held-out image, nats.
  double naive_bayes_log_likelihood = 0.0;  ///< The same with the links cut.

  /// Is a place recognised when a third of what was seen there is missing? Among places that are each one image, the place of
  /// the image itself has the highest likelihood for the words of a random two thirds of its descriptors.
  std::size_t num_recall_queries = 0;
  std::size_t num_recalled = 0;

  /// Are consecutive images found to be of one place? Among the other images, the likeliest is at most three away in their
  /// order. Means nothing where the images are in no order or do not overlap.
  std::size_t num_neighbour_queries = 0;
  std::size_t num_neighbours_first = 0;
};

struct SelfTestOptions {
  DetectorModel detector;
  std::size_t max_places = 2000;  ///< Bounds time and memory: places are so many consecutive images at most.
  std::size_t max_queries = 200;  ///< Bounds time.
  std::uint64_t seed = 1;
};

/// Runs it on a model's tree. `observations` and `two_thirds` are the words of all, and of two thirds of, each image's
/// descriptors.
SelfTest self_test(const ChowLiuTree& tree, const std::vector<Observation>& observations,
                   const std::vector<Observation>& two_thirds, const std::optional<HeldOut>& held_out,
                   const SelfTestOptions& options = {});

}  // namespace fabloop
