// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "posegraph/sfm/segment.h"

namespace fabloop {

struct TrackTriangulationOptions {
  /// Largest angle between two of a point's rays must be at least this. Less keeps points of video and of narrow overlaps whose
  /// depth is vague.
  double min_parallax_deg = 1.5;
  double max_error_px = 4.0;  ///< Of a sighting. More while poses are rough.
  int num_threads = 0;        ///< 0: all. The result does not depend on it.
};

/// The point nearest to all rays, each distance over the ray's length to it: the linear triangulation that any number of views
/// allows. None when the rays are parallel. Rays are unit, in the world.
std::optional<Eigen::Vector3d> meeting_point(const std::vector<Eigen::Vector3d>& centres,
                                             const std::vector<Eigen::Vector3d>& rays);

/// The point of a track as its placed views see it: of the pairs of rays, the one with which most views agree, then all of
/// those. None when no two agree at a sufficient parallax.
std::optional<SegmentPoint> triangulate_track(const Scene& scene, const Segment& segment, std::size_t track,
                                              const TrackTriangulationOptions& options = {});

/// What becomes of the given tracks' points under the present poses: views that agree by now are added, those that no longer do
/// are removed, points that lose their support are found anew or dropped.
void refresh_points(const Scene& scene, Segment& segment, const std::vector<std::uint32_t>& tracks,
                    const TrackTriangulationOptions& options = {});

/// The same of all tracks.
void refresh_all_points(const Scene& scene, Segment& segment, const TrackTriangulationOptions& options = {});

}  // namespace fabloop
