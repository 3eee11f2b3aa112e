// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/rotation.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "frontend/geometry/camera.h"
#include "frontend/geometry/pose.h"
#include "frontend/geometry/readout_motion.h"

/// Errors of bundle adjustment. A view is one block of six numbers: the rotation vector w by which it turns from where it
/// started, world_from_camera = start * exp(w), and the camera's centre in the world. From a start that is not far off, w needs
/// no manifold.
namespace fabloop::bundle {

/// Size of a view's block.
inline constexpr int kViewSize = 6;

/// Jr(w) of exp(w + d) = exp(w) exp(Jr(w) d) for small d (Sola et al. 2018, eq. 143).
inline Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& w) {
  const double angle2 = w.squaredNorm();
  constexpr double kSmall = 1e-8;  // beyond, the closed form loses no digits that matter
  const double angle = std::sqrt(angle2);
  const double of_cross = angle2 < kSmall ? 0.5 - angle2 / 24.0 : (1.0 - std::cos(angle)) / angle2;
  const double of_square = angle2 < kSmall ? 1.0 / 6.0 - angle2 / 120.0 : (angle - std::sin(angle)) / (angle2 * angle);
  const Eigen::Matrix3d cross = cross_matrix(w);
  return Eigen::Matrix3d::Identity() - of_cross * cross + of_square * cross * cross;
}

/// What a view's block says, worked out once for all sightings of the view that are evaluated after one another. Each sighting
/// asks at the block's present numbers; not for several threads.
class TurnedView {
 public:
  explicit TurnedView(const Eigen::Quaterniond& start) : start_(start) { turn(Eigen::Vector3d::Zero()); }

  const Eigen::Quaterniond& start() const { return start_; }
  const Eigen::Matrix3d& camera_from_world() const { return camera_from_world_; }
  const Eigen::Matrix3d& right_jacobian() const { return right_jacobian_; }

  void turn_to(const double* block) {
    const Eigen::Map<const Eigen::Vector3d> w(block);
    if (w != w_) turn(w);
  }

 private:
  void turn(const Eigen::Vector3d& w) {
    w_ = w;
    camera_from_world_ = (start_ * rotation_from_vector(w)).conjugate().toRotationMatrix();
    right_jacobian_ = bundle::right_jacobian(w);
  }

  Eigen::Quaterniond start_;
  Eigen::Vector3d w_;
  Eigen::Matrix3d camera_from_world_, right_jacobian_;
};

/// Error in pixels of an ideal pinhole with the lens's distortion undone beforehand: the camera's numbers are constants then, so
/// that any lens model costs the same. The pixels are of the undistorted image. Blocks: view, point.
class PinholeError final : public ceres::SizedCostFunction<2, kViewSize, 3> {
 public:
  /// `normalised` is where the ray meets z = 1. The view must outlive it.
  PinholeError(TurnedView& view, double focal_x, double focal_y, const Eigen::Vector2d& normalised)
      : view_(&view), focal_x_(focal_x), focal_y_(focal_y), normalised_(normalised) {}

  /// Of a ray without the lens's distortion (camera frame), in units of `pixel_size` of the camera's pixels, seen at `share` of a
  /// rolling shutter's readout. What the camera has moved and turned by then are constants of the sighting, so that the blocks
  /// and the derivatives stay those of a global shutter.
  PinholeError(TurnedView& view, const Camera& camera, double pixel_size, const Eigen::Vector3d& ray,
               const ReadoutMotion& readout, double share)
      : PinholeError(view, camera.fx / pixel_size, camera.fy / pixel_size,
                     (rotation_from_vector(share * readout.turn) * ray).hnormalized()) {
    shift_in_world_ = share * readout.shift_in_world;
  }

  bool Evaluate(const double* const* blocks, double* error, double** by_block) const override {
    view_->turn_to(blocks[0]);
    const Eigen::Matrix3d& camera_from_world = view_->camera_from_world();
    const Eigen::Map<const Eigen::Vector3d> centre(blocks[0] + 3), x_in_world(blocks[1]);
    const Eigen::Vector3d x = camera_from_world * (x_in_world - centre - shift_in_world_);
    constexpr double kLeastDepth = 1e-9;
    if (!(x.z() > kLeastDepth)) return false;
    const double inverse_z = 1.0 / x.z();
    error[0] = focal_x_ * (x.x() * inverse_z - normalised_.x());
    error[1] = focal_y_ * (x.y() * inverse_z - normalised_.y());
    if (by_block == nullptr) return true;
    Eigen::Matrix<double, 2, 3> by_x;
    by_x << focal_x_ * inverse_z, 0, -focal_x_ * x.x() * inverse_z * inverse_z,  //
        0, focal_y_ * inverse_z, -focal_y_ * x.y() * inverse_z * inverse_z;
    const Eigen::Matrix<double, 2, 3> by_point = by_x * camera_from_world;
    if (by_block[0] != nullptr) {
      // x turns by -(Jr d) x x when w changes by d.
      Eigen::Map<Eigen::Matrix<double, 2, kViewSize, Eigen::RowMajor>> by_view(by_block[0]);
      const Eigen::Matrix<double, 2, 3> by_turn = by_x * cross_matrix(x);
      by_view.leftCols<3>() = by_turn * view_->right_jacobian();
      by_view.rightCols<3>() = -by_point;
    }
    if (by_block[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> of_point(by_block[1]);
      of_point = by_point;
    }
    return true;
  }

 private:
  TurnedView* view_;
  double focal_x_, focal_y_;
  Eigen::Vector2d normalised_;
  Eigen::Vector3d shift_in_world_ = Eigen::Vector3d::Zero();
};

/// Error in pixels under a Radtan lens whose focal length (as a factor), k1 and k2 are the block `lens`; the other numbers stay.
/// The same equations as project(). For automatic derivatives. Blocks: view, point, lens.
struct LensError {
  Camera camera;
  Eigen::Quaterniond start;  ///< Of the view.
  Eigen::Vector2d pixel;
  double pixel_size = 1.0;  ///< The errors' unit, in the image's pixels.
  ReadoutMotion readout{};  ///< Of a rolling shutter.
  double share = 0;         ///< Of the readout when the pixel's row is read.

  double k(std::size_t i) const { return i < camera.distortion.size() ? camera.distortion[i] : 0.0; }

  template <typename T>
  bool operator()(const T* view, const T* x_in_world, const T* lens, T* error) const {
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> centre(view + 3), x_world(x_in_world);
    const Eigen::Matrix<T, 3, 1> from_centre = x_world - centre - Eigen::Vector3d(share * readout.shift_in_world).cast<T>();
    const Eigen::Matrix<T, 3, 1> from_start = start.conjugate().cast<T>() * from_centre;
    const T turned_back[3] = {-view[0], -view[1], -view[2]};
    Eigen::Matrix<T, 3, 1> from_middle_row;
    ceres::AngleAxisRotatePoint(turned_back, from_start.data(), from_middle_row.data());
    const Eigen::Matrix<T, 3, 1> p = rotation_from_vector(-share * readout.turn).cast<T>() * from_middle_row;
    if (!(p.z() > T(1e-9))) return false;
    const T x = p.x() / p.z();
    const T y = p.y() / p.z();
    const T r2 = x * x + y * y;
    const T radial = (1.0 + r2 * (lens[1] + r2 * (lens[2] + r2 * k(4)))) / (1.0 + r2 * (k(5) + r2 * (k(6) + r2 * k(7))));
    const T u = x * radial + 2.0 * k(2) * x * y + k(3) * (r2 + 2.0 * x * x);
    const T v = y * radial + k(2) * (r2 + 2.0 * y * y) + 2.0 * k(3) * x * y;
    error[0] = (camera.fx * lens[0] * u + camera.cx - pixel.x()) / pixel_size;
    error[1] = (camera.fy * lens[0] * v + camera.cy - pixel.y()) / pixel_size;
    return true;
  }
};

/// A camera's centre against a known position, in standard deviations. For automatic derivatives. Block: view.
struct PositionError {
  Eigen::Vector3d position;
  Eigen::Vector3d sigma;

  template <typename T>
  bool operator()(const T* view, T* error) const {
    for (int i = 0; i < 3; ++i) error[i] = (view[3 + i] - position[i]) / sigma[i];
    return true;
  }
};

/// A camera's distance from a held one against what it was, as a share of it in standard deviations: holds the unit of length.
/// For automatic derivatives. Block: view.
struct DistanceError {
  Eigen::Vector3d held_centre;
  double distance;
  double relative_sigma;

  template <typename T>
  bool operator()(const T* view, T* error) const {
    const Eigen::Matrix<T, 3, 1> away = Eigen::Map<const Eigen::Matrix<T, 3, 1>>(view + 3) - held_centre.cast<T>();
    error[0] = (away.norm() / distance - 1.0) / relative_sigma;
    return true;
  }
};

}  // namespace fabloop::bundle
