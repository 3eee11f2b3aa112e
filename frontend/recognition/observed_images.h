// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "frontend/fabmap/model.h"
#include "frontend/fabmap/observation.h"
#include "frontend/features/panorama.h"
#include "frontend/progress.h"
#include "frontend/sequence/image_source.h"

namespace fabloop {

/// The words that one image shows.
struct ObservedImage {
  std::size_t frame = 0;  ///< Its position in the source.
  std::int64_t time_ns = 0;
  Observation observation;
  double describe_s = 0.0;  ///< Seconds spent on features.
  double words_s = 0.0;     ///< Seconds spent on words.
};

/// The images of a source as words: a few hundred numbers each, so that long runs stand in memory.
struct ObservedImages {
  std::string name;
  std::vector<ObservedImage> images;        ///< In order of time; those that could not be read are missing.
  std::vector<std::size_t> damaged_frames;  ///< Those.
  double read_s = 0.0;                      ///< Seconds spent on reading and decoding.
};

struct ObserveOptions {
  ImageShape shape = ImageShape::Plain;
  int num_threads = 0;  ///< 0: all. The result does not depend on it.
  Progress progress;
};

/// The words of all images that the source still has. Throws InputError as ImageSource does, and when there are none.
ObservedImages observe_images(ImageSource& source, const Model& model, const ObserveOptions& options = {});

}  // namespace fabloop
