// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "verification/rig/rig_pose.h"

namespace fabloop {

/// Which pairs are seen by the same two cameras: those whose origins are equal on both sides.
struct CameraPairGroups {
  std::vector<std::vector<std::size_t>> members;  ///< Of each group, ascending.
  std::vector<std::size_t> group_of;              ///< Of each pair.
};

/// Groups in the order of their first members.
CameraPairGroups group_by_camera_pair(std::span<const RigRayPair> pairs);

}  // namespace fabloop
