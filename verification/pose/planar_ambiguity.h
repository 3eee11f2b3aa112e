// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "verification/pose/relative_pose.h"

namespace fabloop {

struct PlanarAmbiguityOptions {
  double min_planar_ratio = 0.3;    ///< Share of the inliers that a plane must hold before its poses are looked at.
  double min_support_ratio = 0.75;  ///< True pairs that another pose must have, relative to the best, to be a rival.
  double min_rotation_deg = 3.0;    ///< Poses closer than this, and than `min_direction_deg`, are the same answer.
  double min_direction_deg = 10.0;
};

/// What a plane explains of a pair of views.
struct PlanarScene {
  double planar_ratio = 0;  ///< Share of the inliers that one homography holds.
  /// Clearly different poses that explain the matches nearly as well, best first: two views of a plane have two poses
  /// (Longuet-Higgins 1986), both often in front of both cameras. A rival may have more support than the pose found first.
  std::vector<RelativePose> rivals;
  /// The pose found first, as the plane tells it, where its pairs lie closer on that: along a plane's weak direction a refinement
  /// may stop short.
  std::optional<RelativePose> closer;
};

/// Fits a homography to the inliers of a pose, and refines and counts the poses that it decomposes into where it holds enough.
/// Rays further than about 84 degrees off the axis have no place in a homography and are left out.
PlanarScene planar_scene(std::span<const RayPair> pairs, const RelativePose& best, const RelativePoseOptions& pose_options,
                         const PlanarAmbiguityOptions& options = {});

}  // namespace fabloop
