// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/segment_adjustment.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace fabloop {
namespace {

/// A bundle and what its parts are in the segment.
struct SegmentBundle {
  Bundle bundle;
  std::vector<std::size_t> views;     ///< In the scene.
  std::vector<std::uint32_t> tracks;  ///< Of the points.
};

SegmentBundle bundle_of(const Scene& scene, const Segment& segment, const std::vector<std::uint32_t>& tracks,
                        const std::vector<char>& is_free) {
  constexpr std::size_t kAbsent = std::numeric_limits<std::size_t>::max();
  SegmentBundle result;
  result.bundle.camera = scene.views.front().camera;
  result.bundle.pixel_size = scene.views.front().features.pixel_size;
  std::vector<std::size_t> bundle_view(scene.views.size(), kAbsent);
  for (const std::uint32_t t : tracks) {
    const SegmentPoint& point = *segment.points[t];
    for (const std::uint32_t position : point.seen_by) {
      const TrackFeature& member = scene.tracks.tracks[t][position];
      if (bundle_view[member.view] == kAbsent) {
        bundle_view[member.view] = result.views.size();
        result.views.push_back(member.view);
        result.bundle.views.push_back({*segment.world_from_cameras[member.view], is_free[member.view] == 0, {}});
        if (!segment.readout_motions.empty()) result.bundle.views.back().readout = segment.readout_motions[member.view];
      }
      result.bundle.sightings.push_back({bundle_view[member.view], result.tracks.size(), pixel_of(scene, member)});
    }
    result.bundle.points_in_world.push_back(point.x_in_world);
    result.tracks.push_back(t);
  }
  return result;
}

void take_over(const SegmentBundle& of, const AdjustedBundle& adjusted, Segment& segment) {
  for (std::size_t i = 0; i < of.views.size(); ++i) segment.world_from_cameras[of.views[i]] = adjusted.world_from_cameras[i];
  for (std::size_t i = 0; i < of.tracks.size(); ++i) segment.points[of.tracks[i]]->x_in_world = adjusted.points_in_world[i];
}

/// Those that many views see first, until every view sees enough of those taken.
std::vector<std::uint32_t> select_tracks(const Scene& scene, const Segment& segment, std::size_t num_points_per_view) {
  std::vector<std::uint32_t> tracks;
  for (std::uint32_t t = 0; t < segment.points.size(); ++t) {
    if (segment.points[t]) tracks.push_back(t);
  }
  if (num_points_per_view == 0) return tracks;
  std::stable_sort(tracks.begin(), tracks.end(), [&](std::uint32_t a, std::uint32_t b) {
    return segment.points[a]->seen_by.size() > segment.points[b]->seen_by.size();
  });
  std::vector<std::size_t> count(scene.views.size(), 0);
  std::erase_if(tracks, [&](std::uint32_t t) {
    const auto& seen_by = segment.points[t]->seen_by;
    const auto view_of = [&](std::uint32_t position) { return scene.tracks.tracks[t][position].view; };
    const bool is_wanted = std::any_of(seen_by.begin(), seen_by.end(),
                                       [&](std::uint32_t position) { return count[view_of(position)] < num_points_per_view; });
    if (is_wanted) {
      for (const std::uint32_t position : seen_by) ++count[view_of(position)];
    }
    return !is_wanted;
  });
  std::sort(tracks.begin(), tracks.end());
  return tracks;
}

/// Placed views by how many of a view's points they see, most first.
std::vector<std::size_t> neighbours_of(const Scene& scene, const Segment& segment, std::size_t view, std::size_t count) {
  std::vector<std::size_t> num_shared(scene.views.size(), 0);
  for (const std::uint32_t t : scene.tracks.of_view[view]) {
    if (!segment.points[t]) continue;
    for (const std::uint32_t position : segment.points[t]->seen_by) ++num_shared[scene.tracks.tracks[t][position].view];
  }
  num_shared[view] = 0;
  std::vector<std::size_t> order(scene.views.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return num_shared[a] > num_shared[b]; });
  std::erase_if(order, [&](std::size_t i) { return num_shared[i] == 0; });
  order.resize(std::min(order.size(), count));
  return order;
}

}  // namespace

SegmentAdjustment adjust_segment(const Scene& scene, Segment& segment, const SegmentAdjustmentOptions& options) {
  const std::vector<char> all_free(scene.views.size(), 1);
  SegmentBundle of = bundle_of(scene, segment, select_tracks(scene, segment, options.num_points_per_view), all_free);
  if (options.camera) of.bundle.camera = *options.camera;
  if (!options.known_positions.empty()) {
    for (std::size_t i = 0; i < of.views.size(); ++i) {
      of.bundle.views[i].known_position = options.known_positions[of.views[i]];
      of.bundle.views[i].position_sigma = options.position_sigma;
    }
  }
  const AdjustedBundle adjusted = adjust_bundle(of.bundle, options.bundle);
  take_over(of, adjusted, segment);
  return {adjusted.camera, adjusted.initial_cost, adjusted.final_cost, of.bundle.sightings.size(), adjusted.iterations};
}

void adjust_around(const Scene& scene, Segment& segment, std::size_t view, const LocalAdjustmentOptions& options) {
  const std::vector<std::size_t> neighbours = neighbours_of(scene, segment, view, options.num_neighbours);
  std::vector<char> is_free(scene.views.size(), 0);
  is_free[view] = 1;
  std::vector<std::uint32_t> tracks;
  for (const std::uint32_t t : scene.tracks.of_view[view]) {
    if (segment.points[t]) tracks.push_back(t);
  }
  for (const std::size_t neighbour : neighbours) {
    is_free[neighbour] = 1;
    std::size_t num_taken = 0;
    for (const std::uint32_t t : scene.tracks.of_view[neighbour]) {
      if (!segment.points[t] || segment.points[t]->seen_by.size() < 3) continue;
      tracks.push_back(t);
      if (++num_taken == options.num_points_per_neighbour) break;
    }
  }
  std::sort(tracks.begin(), tracks.end());
  tracks.erase(std::unique(tracks.begin(), tracks.end()), tracks.end());
  const SegmentBundle of = bundle_of(scene, segment, tracks, is_free);
  // With nobody to hold the world in place the segment is small enough to be adjusted as a whole.
  take_over(of, adjust_bundle(of.bundle, options.bundle), segment);
}

}  // namespace fabloop
