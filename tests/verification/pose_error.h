// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "frontend/geometry/pose.h"

namespace fabloop::testing_support {

/// The turn from one attitude to another, in the axes of b.
inline Eigen::Vector3d rotation_between(const Pose& a_from_b_truth, const Pose& a_from_b_found) {
  const Eigen::AngleAxisd turn((a_from_b_truth.rotation.conjugate() * a_from_b_found.rotation).normalized());
  return turn.angle() * turn.axis();
}

/// (translation in a, rotation in b) from the truth to the estimate: the tangent of absolute poses.
inline Eigen::Matrix<double, 6, 1> absolute_error(const Pose& truth, const Pose& found) {
  Eigen::Matrix<double, 6, 1> error;
  error << found.translation - truth.translation, rotation_between(truth, found);
  return error;
}

/// (translation, rotation) from the truth to the estimate, both in b's axes: the tangent of relative poses.
inline Eigen::Matrix<double, 6, 1> relative_error(const Pose& truth, const Pose& found) {
  Eigen::Matrix<double, 6, 1> error;
  error << truth.rotation.conjugate() * (found.translation - truth.translation), rotation_between(truth, found);
  return error;
}

}  // namespace fabloop::testing_support
