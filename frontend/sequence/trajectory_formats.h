// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "frontend/sequence/trajectory.h"

namespace fabloop {

/// How trajectories stand in files.
enum class TrajectoryFormat {
  Tum,    ///< `t tx ty tz qx qy qz qw`, seconds.
  Kitti,  ///< The 12 numbers of the first three rows of world_from_camera; the times stand in a file beside it.
  Euroc,  ///< `t_ns,x,y,z,qw,qx,qy,qz`, with commas; more columns (velocity, biases) are skipped.
};

/// "tum", "kitti" or "euroc"; none for other text.
std::optional<TrajectoryFormat> trajectory_format_named(std::string_view name);

/// Which format a file has, by its first line that is no comment. Throws InputError when it is none of them.
TrajectoryFormat detect_trajectory_format(const std::filesystem::path& path);

/// Reads lines of 12 numbers, and their times [s], one a line, from `times`; without it the file `times.txt` beside it is taken.
/// Throws InputError naming file and line for anything else, for a matrix that is no rotation, and when the numbers of lines
/// differ.
Trajectory read_kitti(const std::filesystem::path& path, const std::filesystem::path& times = {});

/// Writes the poses, and their times to `times` (by default `times.txt` beside it).
void write_kitti(const std::filesystem::path& path, const Trajectory& trajectory, const std::filesystem::path& times = {});

/// Reads EuRoC's ground truth (`state_groundtruth_estimate0/data.csv`). The poses are as they stand: there, of the body, not of
/// a camera (`T_BS` of its sensor.yaml lies between the two). Throws InputError as read_tum() does.
Trajectory read_euroc(const std::filesystem::path& path);

/// Writes what read_euroc() reads, with EuRoC's head line; integer nanoseconds.
void write_euroc(const std::filesystem::path& path, const Trajectory& trajectory);

/// Reads a file of this format; KITTI's times from `times.txt` beside it.
Trajectory read_trajectory(const std::filesystem::path& path, TrajectoryFormat format);

/// Writes a file of this format.
void write_trajectory(const std::filesystem::path& path, const Trajectory& trajectory, TrajectoryFormat format);

}  // namespace fabloop
