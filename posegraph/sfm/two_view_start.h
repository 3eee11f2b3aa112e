// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "posegraph/sfm/segment.h"
#include "posegraph/sfm/track_triangulation.h"
#include "posegraph/sfm/view_graph.h"

namespace fabloop {

struct TwoViewStartOptions {
  double good_parallax_deg = 12.0;  ///< More makes a start no better.
  double min_parallax_deg = 2.0;    ///< Below it depth is vague.
  double max_rotation_share = 0.7;  ///< Inliers that a rotation alone may explain.
  std::size_t min_points = 30;      ///< Of the first two views.
  TrackTriangulationOptions triangulation;
};

/// Pairs to begin with, best first: many inliers, parallax, and one pose only. Pairs of which two poses of a plane are alike come
/// last, whatever else they have.
std::vector<std::size_t> start_order(const std::vector<ViewPair>& pairs, const TwoViewStartOptions& options = {});

/// A segment of the two views of a pair, refined; none when they share too few points. The first view is the world, the baseline
/// the unit.
std::optional<Segment> start_segment(const Scene& scene, const ViewPair& pair, const TwoViewStartOptions& options = {});

}  // namespace fabloop
