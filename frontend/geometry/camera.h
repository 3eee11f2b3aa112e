// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace fabloop {

/// How a lens bends what a pinhole would see.
enum class DistortionModel {
  Radtan,       ///< OpenCV's k1 k2 p1 p2 k3 [k4 k5 k6]: ROS plumb_bob and rational_polynomial, Kalibr radtan.
  Equidistant,  ///< OpenCV's fisheye k1 k2 k3 k4: ROS and Kalibr equidistant.
};

/// A calibrated pinhole camera with a lens. Pixel centres lie at integers ((0, 0) is the centre of the first pixel), as in
/// OpenCV. Camera axes: x right, y down, z forward.
struct Camera {
  int width = 0;                          ///< Pixels.
  int height = 0;                         ///< Pixels.
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< Pixels.
  DistortionModel distortion_model = DistortionModel::Radtan;
  std::vector<double> distortion;  ///< Coefficients in OpenCV's order; empty for none.

  /// Mean focal length in pixels: what turns a pixel error into an angle.
  double focal_px() const { return 0.5 * (fx + fy); }
};

/// Pixel of a point in the camera's frame, or none when the point is not in front of it. The pixel may lie outside the image.
std::optional<Eigen::Vector2d> project(const Camera& camera, const Eigen::Vector3d& x_in_camera);

/// Unit rays (camera frame) through the given pixels.
std::vector<Eigen::Vector3d> bearings(const Camera& camera, const std::vector<Eigen::Vector2d>& pixels);

/// The same lens on an image resized by `factor` (2: twice as wide).
Camera scaled(const Camera& camera, double factor);

/// Throws InputError naming `where` when the numbers cannot be a camera's (no size, focal length not positive, principal
/// point outside the image, non-finite numbers, a wrong count of coefficients).
void validate(const Camera& camera, const std::string& where);

}  // namespace fabloop
