// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "frontend/progress.h"
#include "posegraph/sfm/resection.h"
#include "posegraph/sfm/segment.h"
#include "posegraph/sfm/segment_adjustment.h"
#include "posegraph/sfm/track_triangulation.h"
#include "posegraph/sfm/two_view_start.h"
#include "posegraph/sfm/view_graph.h"

namespace fabloop {

/// Called with a segment that grows, after each view that it was given, from the thread that grows it.
using WatchSegment = std::function<void(const Segment&)>;

struct GrowthOptions {
  TwoViewStartOptions start;
  ResectionOptions resection;
  TrackTriangulationOptions triangulation;
  LocalAdjustmentOptions local;
  /// The whole segment is adjusted again when it has grown by this share since the last time. Less is slower and drifts less.
  double growth_per_adjustment = 0.2;
  std::size_t num_points_per_view = 250;  ///< Of these adjustments; see SegmentAdjustmentOptions.
  std::size_t min_views = 3;              ///< Smaller segments prove nothing.
  std::size_t num_starts = 20;            ///< So many pairs are tried for a segment.
  /// A start is good when this share of the track members of its first views lies on their points.
  double min_start_agreement = 0.6;
  Progress progress;
  WatchSegment watch{};  ///< The result does not depend on it.
};

/// What build_segments() has done: enough to go on from there to the same result.
struct SegmentsSoFar {
  std::vector<Segment> segments;     ///< In the order in which they were begun.
  std::size_t num_starts_tried = 0;  ///< Of start_order(), that of the last segment included.
  bool is_last_growing = false;      ///< The last segment is not at its end, and has just settled.
};

/// Called with what there is so far, whenever a segment has settled or come to its end.
using AfterSettling = std::function<void(const SegmentsSoFar&)>;

/// Adds the views that `may_be_placed` (one a view) allows, the one that sees most of the segment first, until none can be added;
/// at most so many. Returns how many were added.
std::size_t grow(const Scene& scene, Segment& segment, const std::vector<char>& may_be_placed, std::size_t max_added,
                 const GrowthOptions& options = {});

/// Adjusts the whole segment and brings its points up to date, twice.
void settle(const Scene& scene, Segment& segment, const GrowthOptions& options);

/// Segments that cover as many views as can be placed, the largest first: each begins with a pair of views that no other segment
/// has, and grows as far as it goes. Goes on from `so_far`, if it is of the same scene and options.
std::vector<Segment> build_segments(const Scene& scene, const std::vector<ViewPair>& pairs, const GrowthOptions& options = {},
                                    SegmentsSoFar so_far = {}, const AfterSettling& after_settling = {});

}  // namespace fabloop
