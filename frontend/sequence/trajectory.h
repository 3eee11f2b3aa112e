// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// Stamps are whole nanoseconds: a double loses them at epoch time.
inline constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

/// Where a camera was at a time.
struct StampedPose {
  std::int64_t time_ns = 0;
  Pose world_from_camera;
};

/// Poses in order of time, no time twice.
using Trajectory = std::vector<StampedPose>;

/// Reads TUM lines `t tx ty tz qx qy qz qw` (seconds, world_from_camera; `#` comments). Throws InputError naming file and
/// line for anything else, for a quaternion that is not of unit length, and for times that do not ascend.
Trajectory read_tum(const std::filesystem::path& path);

/// Writes TUM lines (times with 9 decimals). The file appears only when it is complete.
void write_tum(const std::filesystem::path& path, const Trajectory& trajectory);

/// Seconds in decimal ("1500000000.123456789", or an integer) to nanoseconds, exactly; none when `text` is no such number.
std::optional<std::int64_t> nanoseconds_from_seconds(std::string_view text);

/// Nanoseconds as seconds with exactly 9 decimals.
std::string seconds_from_nanoseconds(std::int64_t time_ns);

}  // namespace fabloop
