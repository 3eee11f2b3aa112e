// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// `a_from_b` after a step (translation, rotation vector), both in frame b.
inline Pose moved_in_own_frame(const Pose& a_from_b, const Eigen::Matrix<double, 6, 1>& step) {
  return {(a_from_b.rotation * rotation_from_vector(step.tail<3>())).normalized(),
          a_from_b.translation + a_from_b.rotation * step.head<3>()};
}

/// `world_from_frame` after a step: the translation in the world, the rotation vector in the frame itself.
inline Pose moved_in_world(const Pose& world_from_frame, const Eigen::Matrix<double, 6, 1>& step) {
  return {(world_from_frame.rotation * rotation_from_vector(step.tail<3>())).normalized(),
          world_from_frame.translation + step.head<3>()};
}

}  // namespace fabloop
