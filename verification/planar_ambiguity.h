// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "frontend/geometry/pose.h"
#include "verification/relative_pose.h"

namespace fabloop {

struct PlanarAmbiguityOptions {
  double min_planar_ratio = 0.7;    ///< Share of the inliers that a plane must hold before the scene counts as planar.
  double min_support_ratio = 0.75;  ///< Inliers that another pose must have, relative to the best, to be a rival.
  double min_rotation_deg = 3.0;    ///< Poses closer than this, and than `min_direction_deg`, are the same answer.
  double min_direction_deg = 10.0;
};

/// Whether a clearly different pose explains the inliers as well: two views of a plane have two poses (Longuet-Higgins 1986),
/// both often in front of both cameras. The homography's decompositions are refined on the pairs and counted.
bool has_planar_rival(std::span<const RayPair> pairs, const RelativePose& best, const RelativePoseOptions& pose_options,
                      const PlanarAmbiguityOptions& options = {});

}  // namespace fabloop
