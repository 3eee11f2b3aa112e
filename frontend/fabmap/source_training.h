// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "frontend/fabmap/model_training.h"
#include "frontend/features/panorama.h"
#include "frontend/sequence/image_source.h"

namespace fabloop {

struct SourceTrainingOptions {
  ImageShape shape = ImageShape::Plain;
  /// A file that is free to be used until the training ends: it holds all descriptors, since a video gives each image only once.
  /// About 0.8 MB an image with 1,500 SIFT features.
  std::filesystem::path spool;
};

/// A model from all images that the sources still have; see train_model. Needs no calibration. Throws InputError as that does and
/// as ImageSource does.
TrainedModel train_model(std::vector<ImageSource>& sources, const SourceTrainingOptions& source_options,
                         const ModelTrainingOptions& options = {});

}  // namespace fabloop
