// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "frontend/geometry/camera.h"

/// Errors of bundle adjustment, for Ceres' automatic derivatives. A pose is two blocks: the quaternion of world_from_camera in
/// Eigen's storage (x y z w), and the camera's centre.
namespace fabloop::bundle {

/// The point in the camera's axes.
template <typename T>
Eigen::Matrix<T, 3, 1> in_camera(const T* world_from_camera, const T* centre, const T* x_in_world) {
  const Eigen::Map<const Eigen::Quaternion<T>> rotation(world_from_camera);
  const Eigen::Map<const Eigen::Matrix<T, 3, 1>> c(centre);
  const Eigen::Map<const Eigen::Matrix<T, 3, 1>> x(x_in_world);
  const Eigen::Matrix<T, 3, 1> offset = x - c;
  return rotation.conjugate() * offset;
}

/// Error in pixels of an ideal pinhole with the lens's distortion undone beforehand: the camera's numbers are constants then, so
/// that any lens model costs the same. The pixels are of the undistorted image.
struct PinholeError {
  double focal_x = 0, focal_y = 0;
  Eigen::Vector2d normalised;  ///< Where the ray meets z = 1.

  template <typename T>
  bool operator()(const T* world_from_camera, const T* centre, const T* x_in_world, T* error) const {
    const Eigen::Matrix<T, 3, 1> x = in_camera(world_from_camera, centre, x_in_world);
    if (!(x.z() > T(1e-9))) return false;
    error[0] = focal_x * (x.x() / x.z() - normalised.x());
    error[1] = focal_y * (x.y() / x.z() - normalised.y());
    return true;
  }
};

/// Error in pixels under a Radtan lens whose focal length (as a factor), k1 and k2 are the block `lens`; the other numbers stay.
/// The same equations as project().
struct LensError {
  Camera camera;
  Eigen::Vector2d pixel;

  double k(std::size_t i) const { return i < camera.distortion.size() ? camera.distortion[i] : 0.0; }

  template <typename T>
  bool operator()(const T* world_from_camera, const T* centre, const T* x_in_world, const T* lens, T* error) const {
    const Eigen::Matrix<T, 3, 1> p = in_camera(world_from_camera, centre, x_in_world);
    if (!(p.z() > T(1e-9))) return false;
    const T x = p.x() / p.z();
    const T y = p.y() / p.z();
    const T r2 = x * x + y * y;
    const T radial = (1.0 + r2 * (lens[1] + r2 * (lens[2] + r2 * k(4)))) / (1.0 + r2 * (k(5) + r2 * (k(6) + r2 * k(7))));
    const T u = x * radial + 2.0 * k(2) * x * y + k(3) * (r2 + 2.0 * x * x);
    const T v = y * radial + k(2) * (r2 + 2.0 * y * y) + 2.0 * k(3) * x * y;
    error[0] = camera.fx * lens[0] * u + camera.cx - pixel.x();
    error[1] = camera.fy * lens[0] * v + camera.cy - pixel.y();
    return true;
  }
};

/// A camera's centre against a known position, in standard deviations.
struct PositionError {
  Eigen::Vector3d position;
  Eigen::Vector3d sigma;

  template <typename T>
  bool operator()(const T* centre, T* error) const {
    for (int i = 0; i < 3; ++i) error[i] = (centre[i] - position[i]) / sigma[i];
    return true;
  }
};

}  // namespace fabloop::bundle
