// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/reconstruct_stages.h"

#include <algorithm>
#include <string>
#include <utility>

#include "posegraph/evaluation/trajectory_error.h"
#include "posegraph/sfm/camera_rates.h"
#include "posegraph/sfm/kept_work.h"

namespace fabloop {
namespace {

std::vector<std::int64_t> times_of(const Sequence& sequence, const std::vector<View>& views) {
  std::vector<std::int64_t> times_ns;
  for (const View& view : views) times_ns.push_back(sequence.frames[view.frame].time_ns);
  return times_ns;
}

}  // namespace

TrackSet tracks_of(const std::vector<View>& views, const std::vector<ViewPair>& pairs) {
  std::vector<std::size_t> num_features;
  for (const View& view : views) num_features.push_back(view.features.keypoints.size());
  return build_tracks(num_features, pairs);
}

std::vector<Segment> place_views(const Scene& scene, const std::vector<ViewPair>& pairs, ReconstructOptions options,
                                 WorkState& state) {
  if (options.watch) {
    options.growth.watch = [&](const Segment& segment) { options.watch({"placing", scene.views, pairs, segment}); };
  }
  auto kept = state.read_as(kKeptSegments, take_segments);
  const auto keep = [&](const SegmentsSoFar& so_far) { state.write(kKeptSegments, bytes_of(so_far)); };
  std::vector<Segment> segments = build_segments(scene, pairs, options.growth, kept ? std::move(*kept) : SegmentsSoFar{},
                                                 state.keeps() ? keep : AfterSettling{});
  segments = join_segments(scene, std::move(segments), options.join);
  if (segments.empty()) return segments;
  std::vector<char> is_left(scene.views.size(), 1);
  for (const Segment& segment : segments) {
    for (std::size_t view = 0; view < scene.views.size(); ++view) {
      if (segment.world_from_cameras[view]) is_left[view] = 0;
    }
  }
  grow(scene, segments.front(), is_left, scene.views.size(), options.growth);
  return segments;
}

SegmentFinishOptions finish_options(const ReconstructOptions& options) {
  return {options.growth.triangulation, options.max_error_px};
}

void model_shutter(const Sequence& sequence, const std::vector<View>& views, TrackSet& tracks, Segment& segment,
                   Reconstructed& result, const ReconstructOptions& options) {
  const Scene scene{views, tracks};
  const std::vector<std::int64_t> times_ns = times_of(sequence, views);
  const TrackTriangulationOptions& triangulation = options.growth.triangulation;
  result.modelled_readout = result.modelled_readout
                                ? follow_rolling_shutter(scene, segment, times_ns, result.modelled_readout->readout_s,
                                                         triangulation, options.rolling_shutter)
                                : model_rolling_shutter(scene, segment, times_ns, triangulation, options.rolling_shutter);
  if (result.modelled_readout) result.num_merged_points += finish_segment(views, tracks, segment, finish_options(options));
  const double readout_s = result.modelled_readout ? result.modelled_readout->readout_s : 0.0;
  result.rolling_shutter_check = check_rolling_shutter(scene, segment, camera_rates(segment.world_from_cameras, times_ns),
                                                       readout_s, options.rolling_shutter.check);
}

void tell_shutter(const Reconstructed& result, const ReconstructOptions& options) {
  const std::string verdict =
      rolling_shutter_verdict(result.rolling_shutter_check, result.modelled_readout, options.rolling_shutter);
  if (!verdict.empty() && options.warn) options.warn(verdict);
}

Trajectory odometry_of(const Sequence& sequence, const std::vector<View>& views, std::vector<ViewPair> pairs,
                       const Reconstructed& result, const ReconstructOptions& options) {
  std::erase_if(pairs, [&](const ViewPair& pair) {
    return views[pair.query].frame - views[pair.match].frame > options.candidates.num_neighbours;
  });
  TrackSet tracks = tracks_of(views, pairs);
  const Scene scene{views, tracks};
  WorkState none;
  ReconstructOptions unwatched = options;
  unwatched.watch = {};  // it is another map
  std::vector<Segment> segments = place_views(scene, pairs, std::move(unwatched), none);
  Trajectory odometry;
  if (segments.empty()) return odometry;
  finish_segment(views, tracks, segments.front(), finish_options(options));
  if (result.modelled_readout) {
    RollingShutterOptions known = options.rolling_shutter;
    known.shutter = Shutter::RollingKnown;
    known.readout_s = result.modelled_readout->readout_s;
    model_rolling_shutter(scene, segments.front(), times_of(sequence, views), options.growth.triangulation, known);
    finish_segment(views, tracks, segments.front(), finish_options(options));
  }
  for (std::size_t view = 0; view < views.size(); ++view) {
    const auto& pose = segments.front().world_from_cameras[view];
    if (pose) odometry.push_back({sequence.frames[views[view].frame].time_ns, *pose});
  }
  const auto fit = absolute_trajectory_error(odometry, trajectory_of(result.reconstruction), {.alignment = Alignment::Sim3});
  if (!fit) return odometry;  // too short to be compared: it keeps a world of its own
  const Similarity& to = fit->reference_from_estimate;
  for (StampedPose& pose : odometry) {
    pose.world_from_camera = {to.rotation * pose.world_from_camera.rotation,
                              to.scale * (to.rotation * pose.world_from_camera.translation) + to.translation};
  }
  return odometry;
}

}  // namespace fabloop
