// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "frontend/geometry/pose.h"
#include "frontend/geometry/readout_motion.h"

namespace fabloop {

/// How fast a camera moves while it takes an image.
struct CameraRate {
  Eigen::Vector3d turn_per_s = Eigen::Vector3d::Zero();               ///< In the camera's frame, radians per second.
  Eigen::Vector3d velocity_in_world_per_s = Eigen::Vector3d::Zero();  ///< In the world's unit per second.
};

/// Rates of cameras (none for those without a pose; poses and ascending time stamps one a camera) from the poses before and
/// after each. Made for photo flights with coarse time stamps: the direction is that of the neighbours, the speed that of up to
/// three steps on either side, and nothing is taken across a pause. Where the way bends from one step to the next, as between
/// strips, the speed shrinks with the bend's cosine. Turning rates are taken as far as those of one step tell those of the next:
/// wholly from video, not at all from photos seconds apart, whose attitudes say nothing of the wobble between them.
std::vector<CameraRate> camera_rates(const std::vector<std::optional<Pose>>& world_from_cameras,
                                     const std::vector<std::int64_t>& times_ns);

/// What the cameras do within a readout.
std::vector<ReadoutMotion> readout_motions(const std::vector<CameraRate>& rates, double readout_s);

}  // namespace fabloop
