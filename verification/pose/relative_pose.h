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

/// Two rays that are said to see one point.
struct RayPair {
  Eigen::Vector3d query;  ///< Unit, query camera.
  Eigen::Vector3d match;  ///< Unit, match camera.
};

/// Who solves for five pairs. Both find the same essential matrices.
enum class FivePointSolver {
  Lanes,   ///< Four samples at once in the lanes of a vector; see five_point.h.
  OpenGv,  ///< OpenGV's `fivept_nister`: the reference, about twenty times slower.
};

struct RelativePoseOptions {
  double max_error_rad = 0.004;  ///< Distance from the epipolar plane (about 2 px over 500 px of focal length).
  double confidence = 0.999;     ///< Of having drawn one sample without outliers.
  int max_iterations = 10000;    ///< Bounds the time spent on pairs that have no pose.
  std::uint64_t seed = 0;
  std::size_t min_inliers = 0;  ///< Poses with fewer are of no use, and not looked for.
  FivePointSolver solver = FivePointSolver::Lanes;
};

/// How two views relate up to scale.
struct RelativePose {
  Pose match_from_query;                        ///< Translation of unit length: a direction.
  std::vector<std::size_t> inliers;             ///< Indices of agreeing pairs in front of both cameras, ascending.
  Eigen::Matrix<double, 5, 5> information;      ///< Of (rotation in the query frame, direction on its tangent plane), 1/rad^2.
  Eigen::Matrix<double, 3, 2> direction_basis;  ///< The tangent plane's axes in the match frame.
  double noise_rad = 0;                         ///< Standard deviation of the true inliers' distances; see inlier_noise.h.
  double num_true = 0;                          ///< Expected number of true ones among the inliers.
  int iterations = 0;
};

/// Relative pose by RANSAC over OpenGV's five-point solver (Nister 2004), pairs sorted best first; refined on all inliers.
/// None when there are fewer than six pairs or no sample gives a pose.
std::optional<RelativePose> estimate_relative_pose(std::span<const RayPair> pairs, const RelativePoseOptions& options = {});

/// Refines a known pose (an odometry's, say) on the pairs that agree with it; none when fewer than six do.
std::optional<RelativePose> refine_relative_pose(std::span<const RayPair> pairs, const Pose& match_from_query,
                                                 const RelativePoseOptions& options = {});

/// Logarithm of the likelihood of the true pairs about a pose, their noise being as large as it turned out, over that of
/// residuals at random within the threshold: the right one of two poses is often not the one with more inliers, but the one on
/// which they lie closer.
double log_likelihood(const RelativePose& relative, double max_error_rad);

/// The rotation alone that maps the query's rays onto the match's best (Kabsch 1976), robustly: what is left between two views
/// without a baseline.
struct RotationFit {
  Eigen::Quaterniond match_from_query = Eigen::Quaterniond::Identity();
  double share = 0;  ///< Of the given pairs, how many lie within the threshold.
};

/// Fits a rotation to the given pairs; those far off lose their say in a few rounds.
RotationFit fit_rotation(std::span<const RayPair> pairs, std::span<const std::size_t> indices, double max_error_rad);

/// Median angle between the rays of the given pairs once the rotation between the views is undone, radians.
double median_parallax(std::span<const RayPair> pairs, std::span<const std::size_t> indices, const Pose& match_from_query);

}  // namespace fabloop
