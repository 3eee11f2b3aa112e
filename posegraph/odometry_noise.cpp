// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/odometry_noise.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "verification/median.h"

namespace fabloop {
namespace {

/// Medians of the length of a standard normal vector in 3 and 2 dimensions: square roots of the chi-square medians.
constexpr double kMedianLength3d = 1.538;
constexpr double kMedianLength2d = 1.177;
constexpr std::size_t kMinSteps = 10;
/// The images have errors too; an odometry that agrees better than this is not known to be better.
constexpr double kMinRotationDeg = 0.05;
constexpr double kMinTranslation = 0.01;

/// Differences over stretches of one length.
struct Stretches {
  std::vector<double> rotations_deg, directions_deg;
};

}  // namespace

OdometryNoise estimate_odometry_noise(const std::vector<OdometryDifference>& differences, const OdometryNoise& fallback) {
  std::map<std::size_t, Stretches> by_length;
  for (const OdometryDifference& difference : differences) {
    Stretches& stretches = by_length[difference.num_steps];
    stretches.rotations_deg.push_back(difference.rotation_deg);
    stretches.directions_deg.push_back(difference.direction_deg);
  }
  const auto found = std::find_if(by_length.begin(), by_length.end(),
                                  [](const auto& entry) { return entry.second.rotations_deg.size() >= kMinSteps; });
  if (found == by_length.end()) return fallback;
  const auto steps = static_cast<double>(found->first);
  OdometryNoise noise;
  const double rotation_deg = median(found->second.rotations_deg) / kMedianLength3d / std::sqrt(steps);
  noise.rotation_deg = std::max(kMinRotationDeg, rotation_deg);
  // Across a stretch of n steps of length 1 the end is off by n times the direction's error: n translation errors, and n - 1
  // turns, of which the k-th last moves the end by k.
  const double across = steps * rad_from_deg(median(found->second.directions_deg)) / kMedianLength2d;
  const double by_turns = std::pow(rad_from_deg(rotation_deg), 2) * (steps - 1) * steps * (2 * steps - 1) / 6;
  noise.translation = std::sqrt(std::max(kMinTranslation * kMinTranslation, (across * across - by_turns) / steps));
  return noise;
}

Matrix6d odometry_information(double length, double min_length, const OdometryNoise& noise) {
  const double translation_sigma = noise.translation * std::max(length, min_length);
  const double rotation_sigma = rad_from_deg(noise.rotation_deg);
  Matrix6d information = Matrix6d::Zero();
  information.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() / (translation_sigma * translation_sigma);
  information.bottomRightCorner<3, 3>() = Eigen::Matrix3d::Identity() / (rotation_sigma * rotation_sigma);
  return information;
}

}  // namespace fabloop
