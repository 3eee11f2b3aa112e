// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "frontend/geometry/pose.h"
#include "frontend/geometry/similarity.h"
#include "frontend/sequence/trajectory.h"

namespace fabloop {

/// What may be moved before trajectories are compared.
enum class Alignment {
  None,  ///< Nothing: both are in one frame.
  Se3,   ///< Rotation and translation (`evo_ape -a`).
  Sim3,  ///< Also scale, for monocular trajectories without it (`evo_ape -as`).
  Yaw,   ///< Heading and translation, for trajectories that know where down is; z is up (Zhang & Scaramuzza, IROS 2018: posyaw).
};

/// Moments of a list of errors; all zero for an empty one.
struct ErrorStatistics {
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double max = 0.0;
  std::size_t count = 0;
};

ErrorStatistics error_statistics(std::vector<double> errors);

/// A pose of the estimate and the reference's at the same time.
struct PosePair {
  StampedPose estimate;
  Pose reference_from_camera;  ///< world_from_camera of the reference.
};

/// Absolute trajectory error: distances between camera centres after alignment [m].
struct AbsoluteTrajectoryError {
  ErrorStatistics translation_m;
  Similarity reference_from_estimate;
};

/// What absolute_trajectory_error() and relative_pose_error() may be told.
struct TrajectoryErrorOptions {
  /// Sim3 where the estimate has no scale of its own.
  Alignment alignment = Alignment::Se3;
  /// Largest difference between matched times; evo's default. More for loosely stamped logs.
  double max_time_difference_s = 0.01;
  /// Relative errors over stretches of this length of the reference's path; 0: from each matched pose to the next.
  double segment_length_m = 0.0;
};

/// Relative pose error: how far ref_delta^-1 * estimate_delta is from the identity, over each step or stretch.
struct RelativePoseError {
  ErrorStatistics translation_m;
  ErrorStatistics rotation_deg;
};

/// Matches each pose of the shorter trajectory to the nearest in time of the longer (of two as near, the earlier). As in evo, a
/// pose of the longer may be matched twice.
std::vector<PosePair> associate(const Trajectory& estimate, const Trajectory& reference, double max_time_difference_s = 0.01);

/// The similarity that minimises the squared distances of reference to moved estimate points (3 x N each). Umeyama, PAMI 1991,
/// eq. 40-42; for Alignment::Yaw the same over turns about z. None with fewer than 2 points, or where they do not determine it
/// (all in one point).
std::optional<Similarity> align_points(const Eigen::Matrix3Xd& estimate, const Eigen::Matrix3Xd& reference, Alignment alignment);

/// ATE in evo's definition (`evo_ape tum REFERENCE ESTIMATE -a`). None with fewer than 3 matched poses.
std::optional<AbsoluteTrajectoryError> absolute_trajectory_error(const Trajectory& estimate, const Trajectory& reference,
                                                                 const TrajectoryErrorOptions& options = {});

/// RPE in evo's definition (`evo_rpe tum REFERENCE ESTIMATE -d 1 -u f`, or `-d LENGTH -u m
/// --pairs_from_reference`). With Alignment::Sim3 the estimate's
/// steps are scaled first. None with fewer than 2 matched poses, or a path of less than two segment lengths.
std::optional<RelativePoseError> relative_pose_error(const Trajectory& estimate, const Trajectory& reference,
                                                     const TrajectoryErrorOptions& options = {});

}  // namespace fabloop
