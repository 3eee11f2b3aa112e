// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/odometry_noise.h"

#include <algorithm>
#include <cmath>

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

}  // namespace

OdometryNoise estimate_odometry_noise(const std::vector<double>& rotation_errors_deg,
                                      const std::vector<double>& direction_errors_deg, const OdometryNoise& fallback) {
  OdometryNoise noise = fallback;
  if (rotation_errors_deg.size() >= kMinSteps) {
    noise.rotation_deg = std::max(kMinRotationDeg, median(rotation_errors_deg) / kMedianLength3d);
  }
  if (direction_errors_deg.size() >= kMinSteps) {
    noise.translation = std::max(kMinTranslation, rad_from_deg(median(direction_errors_deg)) / kMedianLength2d);
  }
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
