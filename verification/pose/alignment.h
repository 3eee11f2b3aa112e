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

/// One point as both sides know it.
struct PointPair {
  Eigen::Vector3d in_query;
  Eigen::Vector3d in_match;
};

/// Standard deviations of a point at distance d from its own origin, the camera: across the ray `floor` + `across` d, along it
/// `floor` + `along` d + `along_squared` d^2. Depths from parallax are uncertain along the ray alone, and for one baseline with
/// the distance's square (a stereo pair of baseline b and focal length f with a disparity error e: e / (b f)).
struct PointNoise {
  double floor = 0;          ///< Unit of the points. Alone for points that are equally good in all directions.
  double across = 0.003;     ///< Radians: about 1.5 px over 500 px of focal length.
  double along = 0.05;       ///< Share of the distance.
  double along_squared = 0;  ///< Per unit of length.
};

/// Whether both sides have one unit of length.
enum class AlignmentScale { Fixed, Free };

struct AlignmentOptions {
  AlignmentScale scale = AlignmentScale::Fixed;  ///< Free for monocular maps, whose units drift apart.
  PointNoise query_noise = {};
  PointNoise match_noise = {};
  double max_error_sigmas = 3.4;  ///< Of an inlier: 99 % of what the noise model says (chi-square, 3 degrees of freedom).
  double confidence = 0.999;      ///< Of having drawn one sample without outliers.
  int max_iterations = 500;       ///< Bounds the time spent where there is no alignment.
  std::uint64_t seed = 0;
};

/// How two sets of points relate: x_in_match = scale * rotation * x_in_query + translation.
struct PointAlignment {
  Pose match_from_query;
  double scale = 1;                  ///< Units of the match per unit of the query.
  std::vector<std::size_t> inliers;  ///< Ascending.
  /// Of (translation, rotation, logarithm of the scale), the first two in the query's axes. Nothing of a fixed scale.
  Eigen::Matrix<double, 7, 7> information = Eigen::Matrix<double, 7, 7>::Zero();
  double rms_error_sigmas = 0;  ///< Of the inliers, per axis: 1 where the noise model is right.
  int iterations = 0;
};

/// Aligns points by RANSAC over three of them (Arun, Huang & Blostein 1987, by OpenGV; Umeyama 1991 with scale), pairs sorted
/// best first, refined on all inliers with every pair weighed by its own noise. None when fewer than five pairs agree. Throws
/// InputError when the options or the data make no sense.
std::optional<PointAlignment> align_points(std::span<const PointPair> pairs, const AlignmentOptions& options = {});

}  // namespace fabloop
