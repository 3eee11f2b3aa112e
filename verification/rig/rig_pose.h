// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// What one camera of a rig sees, in the axes of the rig's body. A short window of keyframes is a rig too: see
/// keyframe_window.h.
struct RigRay {
  Eigen::Vector3d origin_in_body;  ///< Of the camera.
  Eigen::Vector3d ray_in_body;     ///< Unit.
};

/// Two rays that are said to see one point.
struct RigRayPair {
  RigRay query;
  RigRay match;
};

/// A known point and the ray that is said to see it.
struct RigPointRay {
  Eigen::Vector3d point_in_world;
  RigRay ray;
};

/// How samples become relative poses of a rig.
enum class RigSolver {
  Automatic,         ///< FivePlusOne where some two cameras share five pairs, else GeneralisedEigen.
  FivePlusOne,       ///< Five points within two cameras (Nister 2004) and a sixth elsewhere for the scale (Clipp et al. 2008).
  GeneralisedEigen,  ///< Eight points anywhere (Kneip & Li 2014): a local search from the rotation that aligns the rays.
  SeventeenPoint,    ///< Seventeen points anywhere, linearly (Pless 2003; Li, Hartley & Kim 2008). Needs nearly all inliers.
};

struct RigRelativePoseOptions {
  double max_error_rad = 0.004;             ///< Distance of a ray from the epipolar plane of its pair of cameras.
  double confidence = 0.999;                ///< Of having drawn one sample without outliers.
  int max_iterations = 1500;                ///< Bounds the time spent on pairs that have no pose.
  RigSolver solver = RigSolver::Automatic;  ///< Change it for comparison.
  double max_scale_sigma = 0.1;             ///< Largest scale_sigma of a translation that is called metric.
  std::uint64_t seed = 0;
};

/// How the bodies of a rig at two places relate.
struct RigRelativePose {
  Pose match_from_query;             ///< Of the bodies. Without scale the translation is a direction of arbitrary length.
  bool has_scale = false;            ///< Whether the pairs tell the translation's length: see scale_sigma.
  std::vector<std::size_t> inliers;  ///< Indices of agreeing pairs in front of both cameras, ascending.
  /// Of (translation, rotation), both in the query's axes, from the inliers' scatter. Nearly singular without scale.
  Eigen::Matrix<double, 6, 6> information;
  /// Standard deviation of the translation in its worst direction, as a share of the inliers' baselines (root mean square of
  /// the distances between their two cameras). Infinite where all baselines are parallel: one camera, or a rig that moves
  /// without turning and sees every point with one and the same camera.
  double scale_sigma = 0;
  double rms_error_rad = 0;  ///< Of the inliers.
  int iterations = 0;
  RigSolver solver = RigSolver::Automatic;  ///< The one that was used.
};

/// Relative pose of a rig, in the unit of its cameras' origins, by RANSAC over OpenGV's solvers; pairs sorted best first;
/// refined on all inliers. None when fewer than seven pairs agree. Throws InputError when the options or the data make no sense.
std::optional<RigRelativePose> estimate_rig_relative_pose(std::span<const RigRayPair> pairs,
                                                          const RigRelativePoseOptions& options = {});

struct RigAbsolutePoseOptions {
  double max_error_rad = 0.008;  ///< Angle between the ray and the way from its camera to the point.
  double confidence = 0.999;     ///< Of having drawn one sample without outliers.
  int max_iterations = 500;      ///< Bounds the time spent where there is no pose.
  std::uint64_t seed = 0;
};

/// Where a rig is among known points.
struct RigAbsolutePose {
  Pose world_from_body;
  std::vector<std::size_t> inliers;         ///< Ascending.
  Eigen::Matrix<double, 6, 6> information;  ///< Of (translation in the world, rotation in the body).
  double rms_error_rad = 0;                 ///< Of the inliers, per axis.
  int iterations = 0;
};

/// Pose by RANSAC over OpenGV's generalised three-point solver (Kneip, Furgale & Siegwart 2013; the central one for three rays of
/// one camera), data sorted best first; refined on all inliers. None when fewer than five data agree.
std::optional<RigAbsolutePose> estimate_rig_absolute_pose(std::span<const RigPointRay> data,
                                                          const RigAbsolutePoseOptions& options = {});

}  // namespace fabloop
