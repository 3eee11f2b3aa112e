// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "frontend/progress.h"
#include "frontend/sequence/trajectory.h"
#include "posegraph/sfm/loop_link.h"
#include "posegraph/sfm/reconstruction.h"

namespace fabloop {

/// What a run folder says of a map.
struct MapRun {
  Reconstruction reconstruction;  ///< Points have tracks where the run has a COLMAP model (structure from motion).
  Trajectory odometry;            ///< trajectory_odometry.tum; empty where there is none.
  std::vector<LoopLink> loops;    ///< Accepted ones of loops.csv; empty where there is none.
};

/// Where the parts of a run are that its folder does not hold.
struct RunReadOptions {
  std::filesystem::path camera{};  ///< Calibration file. Empty: as read_sequence() finds it.
  Warn warn{};
};

/// Reads the folder that `fabloop map` writes (trajectory.tum and points.ply; trajectory_odometry.tum and loops.csv where they
/// are there) with the images of its sequence, whose times are matched to the trajectory's; of a run from images alone its
/// `colmap/`, with the camera as it was refined. Unit and place on Earth are what summary.json says. Throws InputError naming the
/// file.
MapRun read_map_run(const std::filesystem::path& run, const std::filesystem::path& sequence, const RunReadOptions& options = {});

/// The map of a run from images alone, as its `colmap/` has it, with the times of its trajectory; none where the run has no such
/// model. Throws InputError naming the file, also where model and trajectory are not of one run.
std::optional<Reconstruction> read_reconstruction(const std::filesystem::path& run);

/// Reads points with colours from PLY as `fabloop map` writes it: binary little-endian, float x y z, uchar red green blue.
std::vector<ScenePoint> read_points_ply(const std::filesystem::path& path);

}  // namespace fabloop
