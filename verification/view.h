// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "frontend/features/features.h"
#include "frontend/geometry/camera.h"

namespace fabloop {

/// One image as geometry sees it: N features, the ray of each, and the point it shows where its depth is known.
struct View {
  std::size_t frame = 0;  ///< Position in its sequence.
  Camera camera;
  Features features;                                             ///< N.
  std::vector<Eigen::Vector3d> rays;                             ///< N, unit, camera frame.
  std::vector<std::optional<Eigen::Vector3d>> points_in_camera;  ///< N, metres where the odometry is metric.
};

/// A view without points.
View make_view(std::size_t frame, const Camera& camera, Features features);

/// Number of features whose depth is known.
std::size_t count_points(const View& view);

}  // namespace fabloop
