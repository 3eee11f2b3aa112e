// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frontend/sequence/sequence.h"
#include "frontend/sequence/trajectory.h"

namespace fabloop {

/// The reference (Frame::world_from_camera) of those frames that have one. Only evaluation may look at it.
Trajectory reference_trajectory(const Sequence& sequence);

/// The host's odometry (Frame::odom_from_camera) of those frames that have it; its world is the odometry's frame.
Trajectory odometry_trajectory(const Sequence& sequence);

}  // namespace fabloop
