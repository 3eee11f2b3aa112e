// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "frontend/geometry/camera.h"
#include "frontend/geometry/pose.h"

namespace fabloop {

/// How a camera with a rolling shutter moves from the first row of an image to the last, at a constant rate. Its pose is that of
/// the middle row.
struct ReadoutMotion {
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();            ///< Rotation vector in the camera's frame, radians.
  Eigen::Vector3d shift_in_world = Eigen::Vector3d::Zero();  ///< Of the camera's centre.
};

/// When a row is read, as a share of the readout: -1/2 at the first row's edge, 0 in the middle, 1/2 at the last row's edge.
inline double readout_share(const Camera& camera, double row_px) {
  constexpr double kPixelCentre = 0.5;
  return (row_px + kPixelCentre) / camera.height - 0.5;
}

/// The pose of a camera while it reads the row at `share` of its readout.
inline Pose pose_at_row(const Pose& world_from_camera, const ReadoutMotion& motion, double share) {
  return {world_from_camera.rotation * rotation_from_vector(share * motion.turn),
          world_from_camera.translation + share * motion.shift_in_world};
}

}  // namespace fabloop
