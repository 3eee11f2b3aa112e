// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// A known point and the ray that is said to see it.
struct PointRay {
  Eigen::Vector3d point_in_world;  ///< In any frame "world": for a loop, the match's camera.
  Eigen::Vector3d ray_in_camera;   ///< Unit.
};

struct AbsolutePoseOptions {
  /// Angle between the ray and the point's direction; triangulated points need more than rays alone.
  double max_error_rad = 0.008;
  double confidence = 0.999;  ///< Of having drawn one sample without outliers.
  int max_iterations = 500;   ///< Bounds the time spent where there is no pose.
  /// Standard deviation of a ray per axis, where it is known: an extractor's, say. Without it the inliers' own scatter is taken.
  std::optional<double> noise_rad = std::nullopt;
  std::uint64_t seed = 0;
};

/// Where a camera is among known points.
struct AbsolutePose {
  Pose world_from_camera;
  std::vector<std::size_t> inliers;         ///< Ascending.
  Eigen::Matrix<double, 6, 6> information;  ///< Of (translation in the world, rotation in the camera).
  double rms_error_rad = 0;                 ///< Of the inliers, per axis.
  int iterations = 0;
};

/// Pose by RANSAC over OpenGV's three-point solver (Kneip et al. 2011), data sorted best first; refined on all inliers. None
/// when there are fewer than five data or no sample gives a pose. The information is the Hessian over the noise's variance,
/// which is the inliers' scatter with the tail beyond the threshold restored (or noise_rad).
std::optional<AbsolutePose> estimate_absolute_pose(std::span<const PointRay> data, const AbsolutePoseOptions& options = {});

}  // namespace fabloop
