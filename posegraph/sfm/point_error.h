// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>

#include "frontend/sequence/trajectory.h"
#include "posegraph/evaluation/trajectory_error.h"
#include "posegraph/sfm/reconstruction.h"

namespace fabloop {

/// How far a map's points lie from where the cameras of a reference see them, after alignment of the trajectories.
struct PointError {
  ErrorStatistics across_m;  ///< In the reference's x and y: what an orthomosaic is off by where z is up.
  ErrorStatistics height_m;  ///< In its z.
};

/// Triangulates the points' sightings again with the reference's poses, and compares: both have the sightings' noise, so that the
/// poses alone make the difference. Points without two sightings from the reference, or with less than 2 degrees between them,
/// are not compared. None where the trajectories cannot be aligned or no point is left.
std::optional<PointError> point_error(const Reconstruction& map, const Trajectory& reference,
                                      const TrajectoryErrorOptions& options = {});

}  // namespace fabloop
