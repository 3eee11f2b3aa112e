// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "frontend/geometry/pose.h"
#include "frontend/sequence/trajectory.h"

namespace fabloop {

/// For each time (any order), the pose of `trajectory` nearest in time where it is at most `max_difference_ns` away; of two
/// equally near ones, the earlier.
std::vector<std::optional<Pose>> poses_at(const Trajectory& trajectory, const std::vector<std::int64_t>& times_ns,
                                          std::int64_t max_difference_ns);

}  // namespace fabloop
