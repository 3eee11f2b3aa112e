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

/// All points in the adjustment, and the bound on their errors as it shall be in the result. Returns the camera.
Camera finish(const Scene& scene, Segment& segment, const ReconstructOptions& options) {
  TrackTriangulationOptions strict = options.growth.triangulation;
  SegmentAdjustmentOptions adjustment;
  refresh_points(scene, segment, strict);
  adjust_segment(scene, segment, adjustment);
  strict.max_error_px = options.max_error_px;
  refresh_points(scene, segment, strict);
  adjustment.bundle.refine = options.refine;
  const SegmentAdjustment last = adjust_segment(scene, segment, adjustment);
  return last.camera;
}

cv::Vec3b colour_of(const ColourViews& views, const Track& track, const SegmentPoint& point) {
  cv::Vec3d sum(0, 0, 0);
  for (const std::uint32_t i : point.seen_by) sum += cv::Vec3d(views.red_green_blue[track[i].view][track[i].feature]);
  return cv::Vec3b(sum * (1.0 / static_cast<double>(point.seen_by.size())));
}

Reconstruction to_reconstruction(const Sequence& sequence, const ColourViews& views, const Scene& scene, const Segment& segment,
                                 const Camera& camera) {
  Reconstruction result;
  result.cameras = {camera};
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
    for (const std::uint32_t i : segment.points[t]->seen_by) point.track.push_back({image_of[track[i].view], pixel_of(scene, track[i])});
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
  const auto num_pairs = std::count_if(pairs.begin(), pairs.end(),
                                       [&](const ViewPair& pair) { return pair.query == view || pair.match == view; });
  if (num_pairs == 0) return "no other image provably overlaps it";
  const std::size_t num_seen = visibility(scene, segments.front(), view).num_points;
  if (num_seen < options.resection.min_inliers) {
    return "sees only " + std::to_string(num_seen) + " points of the map, where " +
           std::to_string(options.resection.min_inliers) + " are needed";
  }
  return "too few of the " + std::to_string(num_seen) + " points that it should see agree on one place";
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
  const auto candidates = candidate_pairs(views.views, model, {}, options.candidates);
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
  const Camera camera = finish(scene, segments.front(), options);
  stages.end("adjust");
  const ReprojectionStatistics statistics = reprojection_statistics(scene, segments.front());
  result.mean_error_px = statistics.mean_px;
  result.num_sightings = statistics.num_sightings;
  result.reconstruction = to_reconstruction(sequence, views, scene, segments.front(), camera);
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
    result.pairs.push_back({views.views[pair.query].frame, views.views[pair.match].frame, pair.inliers.size(), pair.median_parallax_deg});
  }
  return result;
}

}  // namespace fabloop
