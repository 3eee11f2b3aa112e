// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// A similarity a_from_b: a rigid transform between frames whose units differ. x_in_a = scale * (rotation * x_in_b) +
/// translation: `scale` is how many units of a one unit of b is, and the translation, in units of a, is b's origin seen in a.
struct Similarity {
  double scale = 1.0;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  /// b_from_a.
  Similarity inverse() const {
    const Eigen::Quaterniond inverse_rotation = rotation.conjugate();
    return {1.0 / scale, inverse_rotation, -1.0 / scale * (inverse_rotation * translation)};
  }
};

/// a_from_c = a_from_b * b_from_c. The rotation is renormalised, so that long chains stay rotations.
inline Similarity operator*(const Similarity& a_from_b, const Similarity& b_from_c) {
  return {a_from_b.scale * b_from_c.scale, (a_from_b.rotation * b_from_c.rotation).normalized(),
          a_from_b.translation + a_from_b.scale * (a_from_b.rotation * b_from_c.translation)};
}

/// x_in_a = a_from_b * x_in_b.
inline Eigen::Vector3d operator*(const Similarity& a_from_b, const Eigen::Vector3d& x_in_b) {
  return a_from_b.scale * (a_from_b.rotation * x_in_b) + a_from_b.translation;
}

/// The rigid transform as a similarity of scale 1.
inline Similarity similarity_from(const Pose& a_from_b) { return {1.0, a_from_b.rotation, a_from_b.translation}; }

/// Where b's origin and axes are in a, in units of a: the similarity without its scale.
inline Pose pose_of(const Similarity& a_from_b) { return {a_from_b.rotation, a_from_b.translation}; }

/// Coordinates in the Lie algebra sim(3): translation (upsilon), rotation vector (omega), logarithm of the scale (sigma).
using Vector7d = Eigen::Matrix<double, 7, 1>;

/// The similarity of scale e^sigma that turns by omega and moves by W upsilon, W = int_0^1 e^(sigma u) Exp(u omega) du
/// (Strasdat, Montiel & Davison, Scale drift-aware large scale monocular SLAM, RSS 2010, section III-B).
Similarity similarity_from_log(const Vector7d& coordinates);

/// Inverse of similarity_from_log(): the coordinates whose rotation vector is at most pi long.
Vector7d log_of(const Similarity& similarity);

}  // namespace fabloop
