// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "frontend/geometry/camera.h"
#include "frontend/geometry/pose.h"

namespace fabloop {

/// Where in view b the points on a ray of view a may be seen, at any depth and beyond: the epipolar line, as pieces of curves
/// (pixels, a few apart) that end just outside of the image. Bent where the lens bends it. Empty for a pose without a
/// translation.
std::vector<std::vector<cv::Point2f>> epipolar_curve(const Eigen::Vector3d& ray_in_a, const Pose& b_from_a,
                                                     const Camera& camera_b);

}  // namespace fabloop
