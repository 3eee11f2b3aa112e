// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/segments.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "verification/pose/alignment.h"
#include "verification/verifier.h"

namespace fabloop {
namespace {

/// Median distance of the points from those who see them.
double median_distance(const Scene& scene, const Segment& segment) {
  std::vector<double> distances;
  for (std::size_t t = 0; t < segment.points.size(); ++t) {
    if (!segment.points[t]) continue;
    const TrackFeature& member = scene.tracks.tracks[t][segment.points[t]->seen_by.front()];
    distances.push_back((segment.points[t]->x_in_world - segment.world_from_cameras[member.view]->translation).norm());
  }
  if (distances.empty()) return 1.0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

std::vector<PointPair> shared_points(const Segment& from, const Segment& to) {
  std::vector<std::pair<std::size_t, PointPair>> shared;
  for (std::size_t t = 0; t < from.points.size(); ++t) {
    if (!from.points[t] || !to.points[t]) continue;
    shared.push_back(
        {from.points[t]->seen_by.size() + to.points[t]->seen_by.size(), {from.points[t]->x_in_world, to.points[t]->x_in_world}});
  }
  std::stable_sort(shared.begin(), shared.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<PointPair> pairs;
  for (const auto& [count, pair] : shared) pairs.push_back(pair);
  return pairs;
}

std::optional<PointAlignment> align(const Scene& scene, const Segment& from, const Segment& to, const JoinOptions& options) {
  const std::vector<PointPair> pairs = shared_points(from, to);
  if (pairs.size() < options.min_inliers) return std::nullopt;
  AlignmentOptions alignment;
  alignment.scale = AlignmentScale::Free;
  alignment.query_noise = {options.point_sigma * median_distance(scene, from), 0.0, 0.0, 0.0};
  alignment.match_noise = {options.point_sigma * median_distance(scene, to), 0.0, 0.0, 0.0};
  alignment.seed = options.seed;
  auto found = align_points(pairs, alignment);
  if (!found || found->inliers.size() < options.min_inliers) return std::nullopt;
  if (static_cast<double>(found->inliers.size()) < options.min_inlier_share * static_cast<double>(pairs.size()))
    return std::nullopt;
  return found;
}

/// The larger segment with the views of the smaller.
Segment joined(const Scene& scene, Segment large, const Segment& small, const PointAlignment& large_from_small,
               const JoinOptions& options) {
  constexpr double kRoughErrorPx = 12.0;  // before the first adjustment
  for (std::size_t view = 0; view < scene.views.size(); ++view) {
    if (!small.world_from_cameras[view] || large.world_from_cameras[view]) continue;
    const Pose& pose = *small.world_from_cameras[view];
    const Pose& by = large_from_small.match_from_query;
    large.world_from_cameras[view] =
        Pose{by.rotation * pose.rotation, large_from_small.scale * (by.rotation * pose.translation) + by.translation};
  }
  GrowthOptions rough = options.growth;
  rough.triangulation.max_error_px = kRoughErrorPx;
  settle(scene, large, rough);
  settle(scene, large, options.growth);
  return large;
}

}  // namespace

std::vector<Segment> join_segments(const Scene& scene, std::vector<Segment> segments, const JoinOptions& options) {
  for (std::size_t large = 0; large < segments.size(); ++large) {
    for (std::size_t small = large + 1; small < segments.size();) {
      const auto large_from_small = align(scene, segments[small], segments[large], options);
      if (!large_from_small) {
        ++small;
        continue;
      }
      segments[large] = joined(scene, std::move(segments[large]), segments[small], *large_from_small, options);
      segments.erase(segments.begin() + static_cast<std::ptrdiff_t>(small));
      small = large + 1;  // the larger one may now share points with those that it did not before
    }
  }
  std::stable_sort(segments.begin(), segments.end(),
                   [](const Segment& a, const Segment& b) { return num_placed(a) > num_placed(b); });
  return segments;
}

}  // namespace fabloop
