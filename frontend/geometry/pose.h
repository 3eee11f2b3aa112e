// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace fabloop {

/// A rigid transform a_from_b: it maps coordinates in frame b into frame a, and its translation is b's origin seen in a.
/// Products cancel neighbours: a_from_c = a_from_b * b_from_c.
struct Pose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  /// b_from_a.
  Pose inverse() const {
    const Eigen::Quaterniond inverse_rotation = rotation.conjugate();
    return {inverse_rotation, -(inverse_rotation * translation)};
  }
};

/// a_from_c = a_from_b * b_from_c. The rotation is renormalised, so that long chains stay rotations.
inline Pose operator*(const Pose& a_from_b, const Pose& b_from_c) {
  return {(a_from_b.rotation * b_from_c.rotation).normalized(), a_from_b.translation + a_from_b.rotation * b_from_c.translation};
}

/// x_in_a = a_from_b * x_in_b.
inline Eigen::Vector3d operator*(const Pose& a_from_b, const Eigen::Vector3d& x_in_b) {
  return a_from_b.rotation * x_in_b + a_from_b.translation;
}

/// Angle of a rotation, in [0, pi] radians.
inline double rotation_angle(const Eigen::Quaterniond& rotation) {
  return 2.0 * std::atan2(rotation.vec().norm(), std::abs(rotation.w()));
}

/// The rotation by |v| radians about v.
inline Eigen::Quaterniond rotation_from_vector(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, angle > 0 ? Eigen::Vector3d(v / angle) : Eigen::Vector3d::UnitX()));
}

/// Its inverse: the rotation vector of a rotation, at most pi long.
inline Eigen::Vector3d vector_from_rotation(const Eigen::Quaterniond& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

/// [v]x: cross_matrix(v) * w = v x w.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  return (Eigen::Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}

/// Angle between two directions, in [0, pi] radians; exact for small ones too.
inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double deg_from_rad(double radians) { return radians * 180.0 / kPi; }
inline constexpr double rad_from_deg(double degrees) { return degrees * kPi / 180.0; }

}  // namespace fabloop
