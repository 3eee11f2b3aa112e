// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/growth.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "frontend/parallel.h"

namespace fabloop {
namespace {

constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();

/// The view that sees most of the segment, those aside that failed with as many points.
std::optional<std::size_t> next_view(const Scene& scene, const Segment& segment, const std::vector<char>& may_be_placed,
                                     const std::vector<std::size_t>& failed_with, const GrowthOptions& options) {
  std::vector<Visibility> visible(scene.views.size());
  parallel_for(scene.views.size(), options.triangulation.num_threads, [&](std::size_t view) {
    if (may_be_placed[view] != 0 && !segment.world_from_cameras[view]) visible[view] = visibility(scene, segment, view);
  });
  std::optional<std::size_t> best;
  std::size_t best_score = 0;
  for (std::size_t view = 0; view < scene.views.size(); ++view) {
    // A view that failed is worth another try when it sees a fifth more.
    const std::size_t num_points = visible[view].num_points;
    if (num_points < options.resection.min_inliers || 5 * num_points <= 6 * failed_with[view]) continue;
    if (visible[view].score > best_score) best = view, best_score = visible[view].score;
  }
  return best;
}

/// Of the members of tracks that two placed views share, the share that lies on a point.
double agreement(const Scene& scene, const Segment& segment) {
  std::size_t num_members = 0;
  std::size_t num_agreeing = 0;
  for (std::size_t t = 0; t < scene.tracks.tracks.size(); ++t) {
    const Track& track = scene.tracks.tracks[t];
    const auto placed = static_cast<std::size_t>(std::count_if(
        track.begin(), track.end(), [&](const TrackFeature& m) { return segment.world_from_cameras[m.view].has_value(); }));
    if (placed < 3) continue;
    num_members += placed;
    if (segment.points[t]) num_agreeing += segment.points[t]->seen_by.size();
  }
  return num_members == 0 ? 0.0 : static_cast<double>(num_agreeing) / static_cast<double>(num_members);
}

}  // namespace

void settle(const Scene& scene, Segment& segment, const GrowthOptions& options) {
  constexpr int kRounds = 2;
  SegmentAdjustmentOptions adjustment;
  adjustment.num_points_per_view = options.num_points_per_view;
  for (int round = 0; round < kRounds; ++round) {
    refresh_all_points(scene, segment, options.triangulation);
    adjust_segment(scene, segment, adjustment);
  }
  refresh_all_points(scene, segment, options.triangulation);
}

namespace {

/// As grow(); calls back when the segment has settled.
std::size_t grow_and_tell(const Scene& scene, Segment& segment, const std::vector<char>& may_be_placed, std::size_t max_added,
                          const GrowthOptions& options, const std::function<void()>& after_settling) {
  std::vector<std::size_t> failed_with(scene.views.size(), 0);
  std::size_t num_added = 0;
  std::size_t placed = num_placed(segment);
  std::size_t placed_at_adjustment = placed;
  const auto adjust_all = [&] {
    settle(scene, segment, options);
    placed_at_adjustment = placed;
    std::fill(failed_with.begin(), failed_with.end(), 0);  // with better points they get another chance
    if (after_settling) after_settling();
  };
  while (num_added < max_added) {
    const auto view = next_view(scene, segment, may_be_placed, failed_with, options);
    if (!view) {
      if (placed == placed_at_adjustment) break;
      adjust_all();
      continue;
    }
    const auto world_from_camera = resect(scene, segment, *view, options.resection);
    if (!world_from_camera) {
      failed_with[*view] = visibility(scene, segment, *view).num_points;
      continue;
    }
    segment.world_from_cameras[*view] = world_from_camera;
    refresh_points(scene, segment, scene.tracks.of_view[*view], options.triangulation);
    adjust_around(scene, segment, *view, options.local);
    refresh_points(scene, segment, scene.tracks.of_view[*view], options.triangulation);
    ++num_added;
    ++placed;
    if (static_cast<double>(placed) >= (1.0 + options.growth_per_adjustment) * static_cast<double>(placed_at_adjustment)) {
      adjust_all();
    }
    if (options.progress) options.progress("placing", placed, scene.views.size());
    if (options.watch) options.watch(segment);
  }
  return num_added;
}

/// A segment that begins with a pair, if its first views bear the pair out.
std::optional<Segment> begin_segment(const Scene& scene, const ViewPair& pair, const std::vector<char>& is_left,
                                     const GrowthOptions& options) {
  constexpr std::size_t kTrialViews = 3;
  auto segment = start_segment(scene, pair, options.start);
  if (!segment) return std::nullopt;
  grow(scene, *segment, is_left, kTrialViews, options);
  if (num_placed(*segment) < options.min_views || agreement(scene, *segment) < options.min_start_agreement) return std::nullopt;
  return segment;
}

void take_views(const Segment& segment, std::vector<char>& is_left) {
  for (std::size_t view = 0; view < is_left.size(); ++view) {
    if (segment.world_from_cameras[view]) is_left[view] = 0;
  }
}

}  // namespace

std::size_t grow(const Scene& scene, Segment& segment, const std::vector<char>& may_be_placed, std::size_t max_added,
                 const GrowthOptions& options) {
  return grow_and_tell(scene, segment, may_be_placed, max_added, options, {});
}

std::vector<Segment> build_segments(const Scene& scene, const std::vector<ViewPair>& pairs, const GrowthOptions& options,
                                    SegmentsSoFar so_far, const AfterSettling& after_settling) {
  std::vector<Segment>& segments = so_far.segments;
  std::vector<char> is_left(scene.views.size(), 1);
  const auto tell = [&](bool is_last_growing) {
    so_far.is_last_growing = is_last_growing;
    if (after_settling) after_settling(so_far);
  };
  const auto finish_last = [&] {
    grow_and_tell(scene, segments.back(), is_left, kNoLimit, options, [&] { tell(true); });
    take_views(segments.back(), is_left);
    tell(false);
  };
  for (const Segment& segment : segments) {
    if (&segment != &segments.back() || !so_far.is_last_growing) take_views(segment, is_left);
  }
  if (so_far.is_last_growing) finish_last();
  const std::vector<std::size_t> order = start_order(pairs, options.start);
  std::size_t num_vain = 0;  // since the last segment
  while (so_far.num_starts_tried < order.size()) {
    const ViewPair& pair = pairs[order[so_far.num_starts_tried++]];
    if (is_left[pair.query] == 0 || is_left[pair.match] == 0) continue;
    if (num_vain++ == options.num_starts) break;
    auto segment = begin_segment(scene, pair, is_left, options);
    if (!segment) continue;
    segments.push_back(std::move(*segment));
    finish_last();
    num_vain = 0;
  }
  std::stable_sort(segments.begin(), segments.end(),
                   [](const Segment& a, const Segment& b) { return num_placed(a) > num_placed(b); });
  return std::move(so_far.segments);
}

}  // namespace fabloop
