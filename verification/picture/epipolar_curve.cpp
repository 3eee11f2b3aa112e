// SPDX-License-Identifier: BSD-3-Clause
#include "verification/picture/epipolar_curve.h"

#include <cmath>
#include <cstddef>
#include <optional>

namespace fabloop {
namespace {

constexpr double kStepPx = 4.0;

/// The pixel in which a ray is seen. None more than a step outside the image, and where the lens model, which holds for the image
/// alone, folds rays from far outside back into it.
std::optional<cv::Point2f> pixel_of(const Camera& camera, const Eigen::Vector3d& ray) {
  constexpr double kSameRayRad = 1e-3;
  constexpr double kEdgePx = 0.5 + 1.5 * kStepPx;
  const auto pixel = project(camera, ray);
  if (!pixel || pixel->x() < -kEdgePx || pixel->y() < -kEdgePx || pixel->x() > camera.width - 1 + kEdgePx ||
      pixel->y() > camera.height - 1 + kEdgePx)
    return std::nullopt;
  if (angle_between(bearings(camera, {*pixel}).front(), ray) > kSameRayRad) return std::nullopt;
  return cv::Point2f(static_cast<float>(pixel->x()), static_cast<float>(pixel->y()));
}

}  // namespace

std::vector<std::vector<cv::Point2f>> epipolar_curve(const Eigen::Vector3d& ray_in_a, const Pose& b_from_a,
                                                     const Camera& camera_b) {
  const Eigen::Vector3d turned = b_from_a.rotation * ray_in_a;
  const Eigen::Vector3d across = b_from_a.translation.cross(turned);
  if (!(across.norm() > 0)) return {};
  // The epipolar plane's great circle.
  const Eigen::Vector3d over = across.normalized().cross(turned);
  const auto num_steps = static_cast<std::size_t>(2.0 * kPi * camera_b.focal_px() / kStepPx);
  std::vector<std::vector<cv::Point2f>> pieces;
  bool goes_on = false;
  for (std::size_t i = 0; i <= num_steps; ++i) {
    const double angle = 2.0 * kPi * static_cast<double>(i) / static_cast<double>(num_steps);
    const auto pixel = pixel_of(camera_b, std::cos(angle) * turned + std::sin(angle) * over);
    if (pixel && !goes_on) pieces.emplace_back();
    if (pixel) pieces.back().push_back(*pixel);
    goes_on = pixel.has_value();
  }
  return pieces;
}

}  // namespace fabloop
