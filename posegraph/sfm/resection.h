// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "posegraph/sfm/segment.h"

namespace fabloop {

struct ResectionOptions {
  double max_error_px = 6.0;      ///< Of a sighting; refined by bundle adjustment afterwards.
  std::size_t min_inliers = 15;   ///< Fewer do not place a view.
  double min_inlier_share = 0.3;  ///< Of the points it should see. Matches are proven pairwise, so most are right.
  int max_iterations = 1000;
  std::uint64_t seed = 1;
};

/// How many of a segment's points a view should see, and how they spread over its image.
struct Visibility {
  std::size_t num_points = 0;
  /// Cells with a point, over grids of 2, 4, ... 16 cells a side, finer ones counting for more: what Schoenberger & Frahm (CVPR
  /// 2016, section 4.2) choose the next view by.
  std::size_t score = 0;
};

Visibility visibility(const Scene& scene, const Segment& segment, std::size_t view);

/// The pose of a view among a segment's points (three points, RANSAC, refined); none when too few agree.
std::optional<Pose> resect(const Scene& scene, const Segment& segment, std::size_t view, const ResectionOptions& options = {});

}  // namespace fabloop
