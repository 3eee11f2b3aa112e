// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/map_sequence.h"

#include <algorithm>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "posegraph/own_model.h"

namespace fabloop {
namespace {

void require_two_mappable_frames(const Sequence& sequence, const DescribedSequence& described) {
  const auto has_odometry = [&](const DescribedFrame& frame) {
    return sequence.frames[frame.frame].odom_from_camera.has_value();
  };
  if (std::count_if(described.frames.begin(), described.frames.end(), has_odometry) < 2) {
    throw InputError(sequence.name + ": fewer than two readable images have odometry; check the stamps of images and odometry");
  }
}

}  // namespace

SequenceMap map_sequence(const Sequence& sequence, const std::optional<Model>& model, const MapSequenceOptions& options) {
  KeyframeMap earlier;
  if (!options.earlier_map.empty()) {
    if (!model) {
      throw InputError(options.earlier_map.string() +
                       ": an earlier map needs the model that it was made with; a model trained on this sequence is another");
    }
    earlier = read_keyframe_map(options.earlier_map, *model);
  }
  DescribeOptions describe_options;
  describe_options.features = model ? model->features : options.features;
  describe_options.if_damaged = options.if_damaged;
  describe_options.num_threads = options.num_threads;
  describe_options.warn = options.warn;
  describe_options.progress = options.progress;
  DescribedSequence described = describe_sequence(sequence, describe_options);
  require_two_mappable_frames(sequence, described);

  SequenceMap result;
  result.num_damaged = described.damaged_frames.size();
  if (model) {
    result.model = *model;
  } else {
    TrainedModel trained = train_own_model(
        described.frames.size(), [&](std::size_t i) { return described.frames[i].features; },
        {.features = options.features, .seed = options.seed, .num_threads = options.num_threads, .progress = options.progress});
    result.model = std::move(trained.model);
    result.trained_here = trained.report;
  }

  MapperOptions mapper_options = options.mapper;
  mapper_options.loops.num_threads = options.num_threads;
  mapper_options.loops.warn = options.warn;
  mapper_options.loops.verifier.seed = options.seed;
  mapper_options.loops.recognizer.seed = options.seed;
  Mapper mapper(sequence.camera, result.model, mapper_options, std::move(earlier));
  std::size_t num_done = 0;
  for (DescribedFrame& frame : described.frames) {
    const Frame& input = sequence.frames[frame.frame];
    mapper.process(input, std::move(frame));
    if (options.progress) options.progress("mapping", ++num_done, described.frames.size());
    if (options.watch) options.watch(mapper.map());
  }
  result.map = mapper.finish();
  if (options.watch) options.watch(result.map);
  return result;
}

}  // namespace fabloop
