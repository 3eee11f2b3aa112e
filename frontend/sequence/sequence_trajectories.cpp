// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/sequence_trajectories.h"

namespace fabloop {
namespace {

Trajectory poses_of_frames(const Sequence& sequence, std::optional<Pose> Frame::*pose) {
  Trajectory trajectory;
  for (const Frame& frame : sequence.frames) {
    if (frame.*pose) trajectory.push_back({frame.time_ns, *(frame.*pose)});
  }
  return trajectory;
}

}  // namespace

Trajectory reference_trajectory(const Sequence& sequence) { return poses_of_frames(sequence, &Frame::world_from_camera); }

Trajectory odometry_trajectory(const Sequence& sequence) { return poses_of_frames(sequence, &Frame::odom_from_camera); }

}  // namespace fabloop
