// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "frontend/geometry/pose.h"

/// Derivatives with respect to quaternions as Eigen stores them, (x y z w), in the surrounding four-dimensional space: a manifold
/// takes what is tangent. All are checked numerically by the tests.
namespace fabloop::residuals {

using Matrix34 = Eigen::Matrix<double, 3, 4>;

/// p * q = left_product(p) * q.
inline Eigen::Matrix4d left_product(const Eigen::Quaterniond& p) {
  Eigen::Matrix4d matrix;
  matrix.topLeftCorner<3, 3>() = p.w() * Eigen::Matrix3d::Identity() + cross_matrix(p.vec());
  matrix.topRightCorner<3, 1>() = p.vec();
  matrix.bottomLeftCorner<1, 3>() = -p.vec().transpose();
  matrix(3, 3) = p.w();
  return matrix;
}

/// p * q = right_product(q) * p.
inline Eigen::Matrix4d right_product(const Eigen::Quaterniond& q) {
  Eigen::Matrix4d matrix;
  matrix.topLeftCorner<3, 3>() = q.w() * Eigen::Matrix3d::Identity() - cross_matrix(q.vec());
  matrix.topRightCorner<3, 1>() = q.vec();
  matrix.bottomLeftCorner<1, 3>() = -q.vec().transpose();
  matrix(3, 3) = q.w();
  return matrix;
}

/// Derivative of conj(q) * x, the point turned back, by q.
inline Matrix34 turned_back_by_rotation(const Eigen::Quaterniond& q, const Eigen::Vector3d& x) {
  const Eigen::Vector3d u = -q.vec();
  const Eigen::Vector3d u_cross_x = u.cross(x);
  Matrix34 matrix;
  matrix.leftCols<3>() = 2.0 * (q.w() * cross_matrix(x) + cross_matrix(u_cross_x) + cross_matrix(u) * cross_matrix(x));
  matrix.col(3) = 2.0 * u_cross_x;
  return matrix;
}

/// How the error of a rotation is measured, and its derivative by the quaternion.
struct RotationError {
  Eigen::Vector3d value;
  Matrix34 by_rotation;
};

/// 2 vec(q), of the one of q and -q that turns less.
inline RotationError twice_vector_part(const Eigen::Quaterniond& q) {
  const double factor = q.w() < 0.0 ? -2.0 : 2.0;
  RotationError error{factor * q.vec(), Matrix34::Zero()};
  error.by_rotation.leftCols<3>() = factor * Eigen::Matrix3d::Identity();
  return error;
}

/// Log(q): the rotation vector, at most pi long.
inline RotationError rotation_vector(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * q.vec();
  const double w = sign * q.w();
  const double sine = v.norm();
  // Below this the next term of the series, of the order of its square, is no longer seen.
  constexpr double kSmallSine = 1e-9;
  RotationError error;
  if (sine < kSmallSine) {
    error.value = 2.0 / w * v;
    error.by_rotation.leftCols<3>() = 2.0 / w * Eigen::Matrix3d::Identity();
    error.by_rotation.col(3) = -2.0 / (w * w) * v;
  } else {
    const double angle = 2.0 * std::atan2(sine, w);
    const Eigen::Vector3d axis = v / sine;
    const double squared_norm = sine * sine + w * w;
    const Eigen::Matrix3d along = axis * axis.transpose();
    error.value = angle * axis;
    error.by_rotation.leftCols<3>() = angle / sine * (Eigen::Matrix3d::Identity() - along) + 2.0 * w / squared_norm * along;
    error.by_rotation.col(3) = -2.0 * sine / squared_norm * axis;
  }
  error.by_rotation *= sign;
  return error;
}

}  // namespace fabloop::residuals
