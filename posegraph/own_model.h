// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "frontend/fabmap/model_training.h"
#include "frontend/progress.h"

namespace fabloop {

struct OwnModelOptions {
  FeatureOptions features;
  /// Descriptors that the words are made of. 100,000 are fifty a word; more take longer and change little.
  std::size_t max_descriptors = 100000;
  std::uint64_t seed = 1;
  int num_threads = 0;  ///< 0: all. The model does not depend on it.
  Progress progress{};
};

/// A model of the very images that are to be mapped, where no other is given. Their features are in memory, so none are kept.
/// Throws InputError as train_model() does.
TrainedModel train_own_model(std::size_t num_images, const FeatureSource& features, const OwnModelOptions& options);

}  // namespace fabloop
