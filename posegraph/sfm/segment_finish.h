// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/sfm/segment.h"
#include "posegraph/sfm/track_triangulation.h"

namespace fabloop {

struct SegmentFinishOptions {
  TrackTriangulationOptions triangulation;  ///< Of the first adjustment.
  double max_error_px = 3.0;                ///< Of a sighting in the end.
};

/// What is done with a segment that has come to its end: all points in the adjustment, points that are one made one, and the
/// bound on their errors as it shall be in the result. Returns how many became part of another.
std::size_t finish_segment(const std::vector<View>& views, TrackSet& tracks, Segment& segment,
                           const SegmentFinishOptions& options = {});

}  // namespace fabloop
