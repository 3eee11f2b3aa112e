// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/segment_finish.h"

#include "posegraph/sfm/duplicate_points.h"
#include "posegraph/sfm/segment_adjustment.h"

namespace fabloop {

std::size_t finish_segment(const std::vector<View>& views, TrackSet& tracks, Segment& segment,
                           const SegmentFinishOptions& options) {
  const Scene scene{views, tracks};
  TrackTriangulationOptions strict = options.triangulation;
  refresh_all_points(scene, segment, strict);
  adjust_segment(scene, segment);
  strict.max_error_px = options.max_error_px;
  refresh_all_points(scene, segment, strict);
  const std::size_t num_merged = merge_duplicate_points(views, tracks, segment, {.max_error_px = options.max_error_px});
  adjust_segment(scene, segment);
  return num_merged;
}

}  // namespace fabloop
