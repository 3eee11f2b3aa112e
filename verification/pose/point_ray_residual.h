// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "frontend/geometry/pose.h"
#include "verification/pose/levenberg_marquardt.h"

namespace fabloop {

/// Sums the squared chords between rays and the directions of the points they see, r = d - f with d = (x - o) / |x - o|, with
/// respect to a body's pose. Chords are angles to third order, hold for any lens, and are large behind the camera.
///
/// With P = I - d d^T and a step that moves the point by dx = -u + x cross w in the body (u the body's translation, w its
/// rotation, both in its own axes), J = P (-I, [x]x) / |x - o|. P projects, so J^T J and J^T r need no 3 x 6 matrices.
class PointRaySum {
 public:
  /// Adds a point seen from `origin` along the unit `ray`, all in the body.
  void add(const Eigen::Vector3d& x, const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
    const Eigen::Vector3d from_origin = x - origin;
    const double inverse_distance = 1.0 / from_origin.norm();
    const Eigen::Vector3d d = from_origin * inverse_distance;
    const Eigen::Vector3d across = (ray - d.dot(ray) * d) * inverse_distance;
    const Eigen::Vector3d d_scaled = d * inverse_distance;
    const Eigen::Vector3d x_scaled = x * inverse_distance;
    const Eigen::Vector3d x_cross_d = x_scaled.cross(d);
    translation_.diagonal().array() += inverse_distance * inverse_distance;
    translation_.noalias() -= d_scaled * d_scaled.transpose();
    mixed_.noalias() -= d_scaled * x_cross_d.transpose();
    sum_x_ += x_scaled * inverse_distance;
    rotation_.diagonal().array() += x_scaled.squaredNorm();
    rotation_.noalias() -= x_scaled * x_scaled.transpose();
    rotation_.noalias() -= x_cross_d * x_cross_d.transpose();
    gradient_translation_ += across;
    gradient_rotation_ += x.cross(across);
    cost_ += (d - ray).squaredNorm();
  }

  /// By (translation in the world, rotation in the body).
  NormalEquations<6> in_world(const Eigen::Matrix3d& world_from_body_rotation) const {
    const Eigen::Matrix3d& rotation = world_from_body_rotation;
    const Eigen::Matrix3d mixed = mixed_ - cross_matrix(sum_x_);
    NormalEquations<6> normal;
    normal.hessian.topLeftCorner<3, 3>() = rotation * translation_ * rotation.transpose();
    normal.hessian.topRightCorner<3, 3>() = rotation * mixed;
    normal.hessian.bottomLeftCorner<3, 3>() = normal.hessian.topRightCorner<3, 3>().transpose();
    normal.hessian.bottomRightCorner<3, 3>() = rotation_;
    normal.gradient << rotation * gradient_translation_, gradient_rotation_;
    normal.cost = cost_;
    return normal;
  }

 private:
  Eigen::Matrix3d translation_ = Eigen::Matrix3d::Zero(), mixed_ = Eigen::Matrix3d::Zero(), rotation_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum_x_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d gradient_translation_ = Eigen::Vector3d::Zero(), gradient_rotation_ = Eigen::Vector3d::Zero();
  double cost_ = 0;
};

/// Squared sine of the angle between a ray and the way to a point, and 1 (a right angle) for a point behind: what a loop scores
/// by, without a root.
inline double squared_sine(const Eigen::Vector3d& towards, const Eigen::Vector3d& ray) {
  const double along = towards.dot(ray);
  const double squared_distance = towards.squaredNorm();
  return along > 0 ? (squared_distance - along * along) / squared_distance : 1.0;
}

}  // namespace fabloop
