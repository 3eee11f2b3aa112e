// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/reconstruct.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "frontend/error.h"
#include "posegraph/sfm/kept_work.h"
#include "posegraph/sfm/reconstruct_stages.h"
#include "posegraph/sfm/reconstruction_result.h"
#include "posegraph/sfm/segment_adjustment.h"
#include "posegraph/sfm/segment_finish.h"

namespace fabloop {
namespace {

/// Options of the parts with what holds for all of them.
ReconstructOptions with_common(const Sequence& sequence, ReconstructOptions options) {
  options.candidates.seed = options.view_graph.seed = options.growth.resection.seed = options.seed;
  options.candidates.num_threads = options.view_graph.num_threads = options.camera_check.num_threads = options.num_threads;
  options.growth.triangulation.num_threads = options.growth.start.triangulation.num_threads = options.num_threads;
  options.candidates.progress = options.view_graph.progress = options.growth.progress = options.progress;
  options.join.growth = options.growth;
  options.join.seed = options.seed;
  options.rolling_shutter.has_times = sequence.has_times;
  return options;
}

ColourViews read_views(const Sequence& sequence, const std::optional<Model>& model, const ReconstructOptions& options,
                       WorkState& state) {
  ColourViewsOptions view_options;
  view_options.features = model ? model->features : options.features;
  view_options.if_damaged = options.if_damaged;
  view_options.num_threads = options.num_threads;
  view_options.warn = options.warn;
  view_options.progress = options.progress;
  view_options.state = &state;
  return read_colour_views(sequence, view_options);
}

/// The camera refined where the images determine it; the views' rays follow.
void refine_camera(std::vector<View>& views, TrackSet& tracks, Segment& segment, Reconstructed& result,
                   const ReconstructOptions& options) {
  SegmentAdjustmentOptions adjustment;
  adjustment.bundle.refine = options.refine;
  const Camera camera = adjust_segment({views, tracks}, segment, adjustment).camera;
  for (View& view : views) view = make_view(view.frame, camera, std::move(view.features));
  result.camera_was_refined = true;
  result.num_merged_points += finish_segment(views, tracks, segment, finish_options(options));
}

void check_and_refine_camera(std::vector<View>& views, TrackSet& tracks, Segment& segment, Reconstructed& result,
                             const ReconstructOptions& options) {
  result.camera_check = check_camera({views, tracks}, segment, options.camera_check);
  const auto say = [&](const std::string& text) {
    if (options.warn) options.warn(text);
  };
  if (options.refine == RefineCamera::Nothing) {
    if (result.camera_check.is_contradicted) {
      say("the images contradict the camera's focal length: they agree best with " +
          std::to_string(result.camera_check.best_focal_factor) +
          " of it, and the map is bent accordingly; calibrate again, or refine it with --refine focal");
    }
  } else if (result.camera_check.is_determined) {
    refine_camera(views, tracks, segment, result, options);
  } else {
    say("the camera is kept as given: these images leave its focal length open by " +
        std::to_string(100.0 * result.camera_check.relative_sigma) + " %, and refining it would bend the ground into a dome");
  }
}

/// Positions of the views from those of the frames.
std::vector<std::optional<Eigen::Vector3d>> positions_of(const std::vector<View>& views, const ReconstructOptions& options) {
  std::vector<std::optional<Eigen::Vector3d>> positions;
  for (const View& view : views) positions.push_back(options.known_positions[view.frame]);
  return positions;
}

/// The unit and the frame of the known positions, where they are to be used.
LengthUnit take_positions(const Scene& scene, Segment& segment, Reconstructed& result, const ReconstructOptions& options) {
  if (options.known_positions.empty()) {
    result.georeference.why_not = "no positions were given";
    return LengthUnit::Arbitrary;
  }
  const auto positions = positions_of(scene.views, options);
  result.georeference = georeference(segment, positions, options.georeference);
  const auto& found = result.georeference.found;
  if (!found && options.warn) options.warn("the map has no unit and no place on Earth: " + result.georeference.why_not);
  if (!found || options.position_use == PositionUse::Witness) return LengthUnit::Arbitrary;
  move_segment(segment, found->scale, found->known_from_world);
  if (options.position_use == PositionUse::Prior) {
    SegmentAdjustmentOptions adjustment;
    adjustment.known_positions = positions;
    adjustment.position_sigma.setConstant(options.georeference.sigma_m);
    adjust_segment(scene, segment, adjustment);
  }
  return LengthUnit::Metres;
}

std::vector<CandidatePair> find_candidates(const std::vector<View>& views, const std::optional<Model>& model,
                                           const ReconstructOptions& options, WorkState& state) {
  if (auto kept = state.read_as(kKeptCandidates, take_candidates)) return std::move(*kept);
  const auto positions = options.known_positions.empty() ? decltype(options.known_positions){} : positions_of(views, options);
  const auto candidates = candidate_pairs(views, model, positions, options.candidates);
  state.write(kKeptCandidates, bytes_of(candidates));
  return candidates;
}

class StageClock {
 public:
  explicit StageClock(std::vector<StageTime>& times) : times_(times) {}
  /// Ends a stage.
  void end(const char* stage) {
    const auto now = std::chrono::steady_clock::now();
    times_.push_back({stage, std::chrono::duration<double>(now - start_).count()});
    start_ = now;
  }

 private:
  std::vector<StageTime>& times_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

Reconstructed run_stages(const Sequence& sequence, const std::optional<Model>& model, const ReconstructOptions& options,
                         WorkState& state) {
  Reconstructed result;
  StageClock stages(result.times);
  ColourViews views = read_views(sequence, model, options, state);
  keep_frames(views.views, state);
  stages.end("features");
  const auto candidates = find_candidates(views.views, model, options, state);
  result.num_candidate_pairs = candidates.size();
  stages.end("candidates");
  ViewGraphOptions pair_options = options.view_graph;
  pair_options.state = &state;
  const std::vector<ViewPair> pairs = verify_pairs(views.views, candidates, pair_options);
  stages.end("verify");
  TrackSet tracks = tracks_of(views.views, pairs);
  stages.end("tracks");
  const Scene scene{views.views, tracks};
  std::vector<Segment> segments = place_views(scene, pairs, options, state);
  stages.end("placing");
  if (segments.empty()) {
    throw InputError(sequence.name + ": no three of its " + std::to_string(views.views.size()) +
                     " images can be placed: " + std::to_string(pairs.size()) + " of " + std::to_string(candidates.size()) +
                     " pairs provably overlap; more overlap, sharper images or the right calibration may help");
  }
  LengthUnit unit = LengthUnit::Arbitrary;
  const auto begin = [&](std::string_view stage) {
    if (options.watch) options.watch({stage, scene.views, pairs, segments.front(), unit});
  };
  begin("adjust");
  result.num_merged_points = finish_segment(views.views, tracks, segments.front(), finish_options(options));
  stages.end("adjust");
  begin("shutter");
  model_shutter(sequence, views.views, tracks, segments.front(), result, options);
  stages.end("shutter");
  begin("camera");
  check_and_refine_camera(views.views, tracks, segments.front(), result, options);
  if (result.camera_was_refined) model_shutter(sequence, views.views, tracks, segments.front(), result, options);
  tell_shutter(result, options);
  stages.end("camera");
  begin("georeference");
  unit = take_positions(scene, segments.front(), result, options);
  stages.end("georeference");
  begin("result");
  const ReprojectionStatistics statistics = reprojection_statistics(scene, segments.front());
  result.mean_error_px = statistics.mean_px;
  result.feature_pixel_size = scene.views.front().features.pixel_size;
  result.num_sightings = statistics.num_sightings;
  result.reconstruction = to_reconstruction(sequence, views, scene, segments.front());
  result.reconstruction.unit = unit;
  if (unit == LengthUnit::Metres) result.reconstruction.origin = options.origin;
  tell_what_is_left(views, scene, pairs, segments, options.growth, result);
  if (options.also_without_loops) {
    begin("without loops");
    result.odometry = odometry_of(sequence, views.views, pairs, result, options);
    stages.end("without loops");
  }
  return result;
}

}  // namespace

FeatureOptions reconstruction_features() {
  FeatureOptions features;
  features.max_features = 2500;
  return features;
}

Reconstructed reconstruct(const Sequence& sequence, const std::optional<Model>& model, const ReconstructOptions& given) {
  const ReconstructOptions options = with_common(sequence, given);
  if (options.refine != RefineCamera::Nothing) require_refinable(sequence.camera);
  require_readout(options.rolling_shutter);
  WorkState state = open_state(sequence, model, options);
  try {
    return run_stages(sequence, model, options, state);
  } catch (const InputError&) {
    state.discard();  // it is of images or options that must change
    throw;
  }
}

}  // namespace fabloop
