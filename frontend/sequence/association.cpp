// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/association.h"

#include <algorithm>

namespace fabloop {
namespace {

/// |a - b|, which may exceed the signed range.
std::uint64_t distance(std::int64_t a, std::int64_t b) {
  return a > b ? static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b)
               : static_cast<std::uint64_t>(b) - static_cast<std::uint64_t>(a);
}

}  // namespace

std::vector<std::optional<Pose>> poses_at(const Trajectory& trajectory, const std::vector<std::int64_t>& times_ns,
                                          std::int64_t max_difference_ns) {
  std::vector<std::optional<Pose>> poses(times_ns.size());
  for (std::size_t i = 0; i < times_ns.size(); ++i) {
    const std::int64_t time = times_ns[i];
    auto nearest =
        std::partition_point(trajectory.begin(), trajectory.end(), [&](const StampedPose& pose) { return pose.time_ns < time; });
    const bool previous_is_nearer =
        nearest != trajectory.begin() &&
        (nearest == trajectory.end() || distance(std::prev(nearest)->time_ns, time) <= distance(nearest->time_ns, time));
    if (previous_is_nearer) --nearest;
    if (nearest != trajectory.end() && distance(nearest->time_ns, time) <= static_cast<std::uint64_t>(max_difference_ns)) {
      poses[i] = nearest->world_from_camera;
    }
  }
  return poses;
}

}  // namespace fabloop
