// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "frontend/geometry/pose.h"

namespace fabloop {

struct TriangulationOptions {
  /// Rays that meet at a smaller angle say little about depth. 1 degree at 1 px of noise and 500 px of focal length is 11 % of
  /// depth.
  double min_parallax_deg = 1.0;
  double max_error_rad = 0.008;  ///< Largest angle between each ray and the point found.
};

/// The point that two rays see, in camera a (OpenGV's triangulate2: the least-squares meeting point); none when they are too
/// parallel, miss each other, or meet behind a camera. `a_from_b` gives the unit of length.
std::optional<Eigen::Vector3d> triangulate(const Eigen::Vector3d& ray_in_a, const Eigen::Vector3d& ray_in_b, const Pose& a_from_b,
                                           const TriangulationOptions& options = {});

}  // namespace fabloop
