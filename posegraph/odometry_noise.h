// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posegraph/pose_graph.h"

namespace fabloop {

/// How far a step of the odometry is off, one standard deviation.
struct OdometryNoise {
  double rotation_deg = 1.0;  ///< A step, each axis.
  double translation = 0.05;  ///< A step, each axis, as a share of its length.
};

/// The noise as the images show it: robust (median) scatter of the differences between the odometry's steps and those seen
/// in neighbouring images. `fallback` where fewer than 10 steps were seen, and for what the images do not see: the length.
OdometryNoise estimate_odometry_noise(const std::vector<double>& rotation_errors_deg,
                                      const std::vector<double>& direction_errors_deg, const OdometryNoise& fallback = {});

/// Information of an odometry step of the given length (metres). `min_length` keeps a standstill from being certain.
Matrix6d odometry_information(double length, double min_length, const OdometryNoise& noise);

}  // namespace fabloop
