// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "posegraph/sfm/bundle_adjustment.h"
#include "posegraph/sfm/segment.h"

namespace fabloop {

struct SegmentAdjustmentOptions {
  BundleOptions bundle{};
  std::optional<Camera> camera{};  ///< Instead of the views' own.
  /// Points that many views see are taken until each view sees so many of those taken; the others follow the cameras. Fewer is
  /// faster and hardly worse. 0: all points.
  std::size_t num_points_per_view = 0;
  /// Known positions of views (one a view of the scene, or empty) with their standard deviations, in the segment's world.
  std::vector<std::optional<Eigen::Vector3d>> known_positions{};
  Eigen::Vector3d position_sigma = Eigen::Vector3d::Ones();
};

/// What an adjustment of a segment reports.
struct SegmentAdjustment {
  Camera camera;  ///< As refined, or as it was.
  double initial_cost = 0;
  double final_cost = 0;
  std::size_t num_sightings = 0;
  int iterations = 0;
};

/// Bundle adjustment of all placed views. Points left out keep their place: refresh_points() moves them after the cameras.
SegmentAdjustment adjust_segment(const Scene& scene, Segment& segment, const SegmentAdjustmentOptions& options = {});

struct LocalAdjustmentOptions {
  BundleOptions bundle{.max_iterations = 10, .cost_tolerance = 1e-4};
  std::size_t num_neighbours = 4;              ///< Views that move along: those that share most points.
  std::size_t num_points_per_neighbour = 150;  ///< Of those that the view itself does not see.
};

/// Bundle adjustment around one view: it, those that share most points with it, and their points; others hold them in place.
void adjust_around(const Scene& scene, Segment& segment, std::size_t view, const LocalAdjustmentOptions& options = {});

}  // namespace fabloop
