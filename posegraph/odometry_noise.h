// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/pose_graph.h"

namespace fabloop {

/// How far a step of the odometry is off, one standard deviation.
struct OdometryNoise {
  double rotation_deg = 1.0;  ///< A step, each axis.
  double translation = 0.05;  ///< A step, each axis, as a share of its length.
};

/// How a stretch of the odometry differs from what the images at its ends show.
struct OdometryDifference {
  std::size_t num_steps = 1;
  double rotation_deg = 0;   ///< Angle between the two rotations.
  double direction_deg = 0;  ///< Angle between the two directions of translation.
};

/// The noise as the images show it: robust (median) scatter of the differences over single steps, or, where fewer than 10 of
/// these were seen (video, whose neighbours have no parallax), over the shortest stretches of which 10 were, taken as sums of
/// independent errors. `fallback` where there are none. Lengths, which images do not see, are taken to err as much as directions.
OdometryNoise estimate_odometry_noise(const std::vector<OdometryDifference>& differences, const OdometryNoise& fallback = {});

/// Information of an odometry step of the given length (metres). `min_length` keeps a standstill from being certain.
Matrix6d odometry_information(double length, double min_length, const OdometryNoise& noise);

}  // namespace fabloop
