// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "frontend/fabmap/model_training.h"
#include "frontend/features/panorama.h"
#include "frontend/sequence/image_source.h"

namespace fabloop {

struct SourceTrainingOptions {
  ImageSourceOptions source;  ///< How each source is read.
  ImageShape shape = ImageShape::Plain;
};

/// A model from all images of the sources (see ImageSource): see train_model. Needs no calibration. A source gives each image
/// only once, so all descriptors are kept, about 0.8 MB an image with 1,500 SIFT features: beside the state folder, in
/// `STATE_FOLDER.images`, from where a training that was killed goes on too; in memory where there is no state folder. Throws
/// InputError as train_model and ImageSource do, and when the disk is full.
TrainedModel train_model(const std::vector<std::filesystem::path>& sources, const SourceTrainingOptions& source_options,
                         const ModelTrainingOptions& options = {});

}  // namespace fabloop
