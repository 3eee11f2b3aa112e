// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/reconstruct.h"

#include <algorithm>
#include <chrono>

#include "frontend/error.h"
#include "posegraph/sfm/segment_adjustment.h"

namespace fabloop {
namespace {

/// Options of the parts with what holds for all of them.
ReconstructOptions with_common(ReconstructOptions options) {
  options.candidates.seed = options.view_graph.seed = options.growth.resection.seed = options.seed;
  options.candidates.num_threads = options.view_graph.num_threads = options.num_threads;
  options.growth.triangulation.num_threads = options.growth.start.triangulation.num_threads = options.num_threads;
  options.candidates.progress = options.view_graph.progress = options.growth.progress = options.progress;
  options.join.growth = options.growth;
  options.join.seed = options.seed;
  return options;
}

ColourViews read_views(const Sequence& sequence, const std::optional<Model>& model, const ReconstructOptions& options) {
  ColourViewsOptions view_options;
  view_options.features = model ? model->features : options.features;
  view_options.if_damaged = options.if_damaged;
  view_options.num_threads = options.num_threads;
  view_options.warn = options.warn;
  view_options.progress = options.progress;
  return read_colour_views(sequence, view_options);
}

TrackSet tracks_of(const std::vector<View>& views, const std::vector<ViewPair>& pairs) {
  std::vector<std::size_t> num_features;
  for (const View& view : views) num_features.push_back(view.features.keypoints.size());
  return build_tracks(num_features, pairs);
}

/// Segments as far as they grow, join, and grow again.
std::vector<Segment> place(const Scene& scene, const std::vector<ViewPair>& pairs, const ReconstructOptions& options) {
  std::vector<Segment> segments = build_segments(scene, pairs, options.growth);
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

/// All points in the adjustment, and the bound on their errors as it shall be in the result.
void finish(const Scene& scene, Segment& segment, const ReconstructOptions& options) {
  TrackTriangulationOptions strict = options.growth.triangulation;
  refresh_all_points(scene, segment, strict);
  adjust_segment(scene, segment);
  strict.max_error_px = options.max_error_px;
  refresh_all_points(scene, segment, strict);
  adjust_segment(scene, segment);
}

/// The camera refined where the images determine it; the views' rays follow.
void refine_camera(std::vector<View>& views, const Scene& scene, Segment& segment, Reconstructed& result,
                   const ReconstructOptions& options) {
  SegmentAdjustmentOptions adjustment;
  adjustment.bundle.refine = options.refine;
  const Camera camera = adjust_segment(scene, segment, adjustment).camera;
  for (View& view : views) view = make_view(view.frame, camera, std::move(view.features));
  result.camera_was_refined = true;
  finish(scene, segment, options);
}

void check_and_refine_camera(std::vector<View>& views, const Scene& scene, Segment& segment, Reconstructed& result,
                             const ReconstructOptions& options) {
  result.camera_check = check_camera(scene, segment, options.camera_check);
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
    refine_camera(views, scene, segment, result, options);
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

cv::Vec3b colour_of(const ColourViews& views, const Track& track, const SegmentPoint& point) {
  cv::Vec3d sum(0, 0, 0);
  for (const std::uint32_t i : point.seen_by) sum += cv::Vec3d(views.red_green_blue[track[i].view][track[i].feature]);
  return cv::Vec3b(sum * (1.0 / static_cast<double>(point.seen_by.size())));
}

Reconstruction to_reconstruction(const Sequence& sequence, const ColourViews& views, const Scene& scene, const Segment& segment) {
  Reconstruction result;
  result.cameras = {scene.views.front().camera};
  std::vector<std::size_t> image_of(scene.views.size(), 0);
  for (std::size_t view = 0; view < scene.views.size(); ++view) {
    if (!segment.world_from_cameras[view]) continue;
    const Frame& frame = sequence.frames[scene.views[view].frame];
    image_of[view] = result.images.size();
    result.images.push_back({scene.views[view].frame, frame.image_path, frame.time_ns, 0, *segment.world_from_cameras[view]});
  }
  for (std::size_t t = 0; t < segment.points.size(); ++t) {
    if (!segment.points[t]) continue;
    const Track& track = scene.tracks.tracks[t];
    ScenePoint point{segment.points[t]->x_in_world, colour_of(views, track, *segment.points[t]), {}};
    for (const std::uint32_t i : segment.points[t]->seen_by)
      point.track.push_back({image_of[track[i].view], pixel_of(scene, track[i])});
    result.points.push_back(std::move(point));
  }
  return result;
}

std::string why_left_out(const Scene& scene, const std::vector<ViewPair>& pairs, const std::vector<Segment>& segments,
                         std::size_t view, const GrowthOptions& options) {
  for (std::size_t s = 1; s < segments.size(); ++s) {
    if (segments[s].world_from_cameras[view]) return "belongs to a part that shares too little with the largest";
  }
  const auto num_features = scene.views[view].features.keypoints.size();
  if (num_features < 2 * options.resection.min_inliers) {
    return "shows only " + std::to_string(num_features) + " features: blurred, or of water or sky";
  }
  const auto num_pairs =
      std::count_if(pairs.begin(), pairs.end(), [&](const ViewPair& pair) { return pair.query == view || pair.match == view; });
  if (num_pairs == 0) return "no other image provably overlaps it";
  const std::size_t num_seen = visibility(scene, segments.front(), view).num_points;
  if (num_seen < options.resection.min_inliers) {
    return "sees only " + std::to_string(num_seen) + " points of the map, where " +
           std::to_string(options.resection.min_inliers) + " are needed";
  }
  return "too few of the " + std::to_string(num_seen) + " points that it should see agree on one place";
}

/// Frames without a place, parts of their own, and the pairs.
void tell_what_is_left(const ColourViews& views, const Scene& scene, const std::vector<ViewPair>& pairs,
                       const std::vector<Segment>& segments, const ReconstructOptions& options, Reconstructed& result) {
  for (const UnreadFrame& frame : views.unread) result.left_out.push_back({frame.frame, frame.why});
  for (std::size_t view = 0; view < views.views.size(); ++view) {
    if (segments.front().world_from_cameras[view]) continue;
    result.left_out.push_back({views.views[view].frame, why_left_out(scene, pairs, segments, view, options.growth)});
  }
  std::sort(result.left_out.begin(), result.left_out.end(), [](const auto& a, const auto& b) { return a.frame < b.frame; });
  for (std::size_t s = 1; s < segments.size(); ++s) {
    result.other_parts.emplace_back();
    for (std::size_t view = 0; view < views.views.size(); ++view) {
      if (segments[s].world_from_cameras[view]) result.other_parts.back().push_back(views.views[view].frame);
    }
  }
  for (const ViewPair& pair : pairs) {
    result.pairs.push_back({views.views[pair.query].frame, views.views[pair.match].frame, pair.num_matches, pair.inliers.size(),
                            pair.median_parallax_deg});
  }
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

}  // namespace

FeatureOptions reconstruction_features() {
  FeatureOptions features;
  features.max_features = 2500;
  return features;
}

Reconstructed reconstruct(const Sequence& sequence, const std::optional<Model>& model, const ReconstructOptions& given) {
  const ReconstructOptions options = with_common(given);
  Reconstructed result;
  StageClock stages(result.times);
  ColourViews views = read_views(sequence, model, options);
  stages.end("features");
  const auto candidates =
      candidate_pairs(views.views, model,
                      options.known_positions.empty() ? decltype(options.known_positions){} : positions_of(views.views, options),
                      options.candidates);
  result.num_candidate_pairs = candidates.size();
  stages.end("candidates");
  const std::vector<ViewPair> pairs = verify_pairs(views.views, candidates, options.view_graph);
  stages.end("verify");
  const TrackSet tracks = tracks_of(views.views, pairs);
  stages.end("tracks");
  const Scene scene{views.views, tracks};
  std::vector<Segment> segments = place(scene, pairs, options);
  stages.end("placing");
  if (segments.empty()) {
    throw InputError(sequence.name + ": no three of its " + std::to_string(views.views.size()) +
                     " images can be placed: " + std::to_string(pairs.size()) + " of " + std::to_string(candidates.size()) +
                     " pairs provably overlap; more overlap, sharper images or the right calibration may help");
  }
  finish(scene, segments.front(), options);
  stages.end("adjust");
  check_and_refine_camera(views.views, scene, segments.front(), result, options);
  stages.end("camera");
  const LengthUnit unit = take_positions(scene, segments.front(), result, options);
  stages.end("georeference");
  const ReprojectionStatistics statistics = reprojection_statistics(scene, segments.front());
  result.mean_error_px = statistics.mean_px;
  result.num_sightings = statistics.num_sightings;
  result.reconstruction = to_reconstruction(sequence, views, scene, segments.front());
  result.reconstruction.unit = unit;
  if (unit == LengthUnit::Metres) result.reconstruction.origin = options.origin;
  tell_what_is_left(views, scene, pairs, segments, options, result);
  return result;
}

}  // namespace fabloop
