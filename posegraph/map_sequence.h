// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "frontend/fabmap/model.h"
#include "frontend/fabmap/model_training.h"
#include "frontend/progress.h"
#include "frontend/sequence/sequence.h"
#include "posegraph/describe_sequence.h"
#include "posegraph/mapper.h"

namespace fabloop {

/// Called with a map that grows, after each of its frames and once when it is finished, from the thread that makes it.
using WatchMap = std::function<void(const Map&)>;

struct MapSequenceOptions {
  FeatureOptions features;  ///< Only without a model; a model brings its own.
  IfDamaged if_damaged = IfDamaged::Skip;
  MapperOptions mapper;
  std::filesystem::path earlier_map{};  ///< A map of earlier sessions to recognise places in; needs the model that it is of.
  std::uint64_t seed = 1;               ///< Of training, RANSAC and sampling.
  int num_threads = 0;                  ///< 0: all. The result does not depend on it.
  Warn warn;
  Progress progress;
  WatchMap watch{};  ///< For those who show it while it grows. The result does not depend on it.
};

struct SequenceMap {
  Map map;
  Model model;                                 ///< As given, or as trained here.
  std::optional<TrainingReport> trained_here;  ///< When no model was given: on the sequence itself.
  std::size_t num_damaged = 0;                 ///< Images that could not be read.
};

/// From a sequence with odometry to its map: describe the images, train a model on them when none is given, map frame by
/// frame. Throws InputError for what the parts refuse, when an earlier map is given without its model, and when fewer than two
/// frames have both an image and odometry.
SequenceMap map_sequence(const Sequence& sequence, const std::optional<Model>& model, const MapSequenceOptions& options = {});

}  // namespace fabloop
