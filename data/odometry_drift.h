// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// How odometry errs. Errors of rotation and heading make the map bend, those of scale make it too large or too small. With
/// the defaults the 1700 m of the default flight come out about 15 m off (ATE after rigid alignment; 7 to 18 over nine seeds).
struct DriftOptions {
  std::uint64_t seed = 1;
  double scale_error = 0.03;                ///< Every step is too long or too short (one sign, drawn) by this share.
  double translation_noise = 0.02;          ///< Standard deviation of each axis, as a share of the step's length.
  double rotation_noise_deg = 0.5;          ///< Standard deviation of each axis, at each step.
  double heading_drift_deg_per_100m = 3.5;  ///< A slow turn about the vertical, one sign (drawn).
};

/// What a host's odometry would report of a true path: the true steps with errors, chained from the true first pose.
/// Each true step (R, t) becomes R' = R Exp(noise + heading drift), t' = (1 + scale) t + |t| noise, in the earlier camera's
/// frame. Same length as the input.
std::vector<Pose> drifting_odometry(const std::vector<Pose>& world_from_camera, const DriftOptions& options = {});

}  // namespace fabloop
