// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/own_model.h"

namespace fabloop {

TrainedModel train_own_model(std::size_t num_images, const FeatureSource& features, const OwnModelOptions& options) {
  ModelTrainingOptions training;
  training.features = options.features;
  training.max_descriptors = options.max_descriptors;
  training.max_kept_bytes = 0;
  training.seed = options.seed;
  training.num_threads = options.num_threads;
  training.command = "map, on the sequence itself";
  training.progress = options.progress;
  return train_model(num_images, features, training);
}

}  // namespace fabloop
