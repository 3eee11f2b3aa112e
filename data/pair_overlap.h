// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "data/world.h"
#include "frontend/geometry/camera.h"
#include "frontend/geometry/pose.h"

namespace fabloop {

/// A convex piece of ground: its corners (world x, y, metres), counter-clockwise.
using Footprint = std::vector<Eigen::Vector2d>;

/// The ground that a camera sees: where the rays through its four corners meet the terrain. Empty when one misses it.
Footprint ground_footprint(const HeightMap& terrain, const Camera& camera, const Pose& world_from_camera);

/// Square metres.
double area_of(const Footprint& footprint);

/// Area of the intersection over the area of the smaller one, in [0, 1]; 0 when one is empty. Symmetric.
double overlap(const Footprint& a, const Footprint& b);

/// Two frames that see the same ground, i < j.
struct OverlappingPair {
  std::size_t i, j;
  double distance_m;  ///< Between the camera centres.
  double overlap;
};

/// Pairs with j - i > `min_gap` and at least `min_overlap`, in order of i, then j.
std::vector<OverlappingPair> overlapping_pairs(const HeightMap& terrain, const Camera& camera,
                                               const std::vector<Pose>& world_from_camera, std::size_t min_gap,
                                               double min_overlap);

}  // namespace fabloop
