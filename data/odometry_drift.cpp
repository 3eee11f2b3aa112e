// SPDX-License-Identifier: BSD-3-Clause
#include "data/odometry_drift.h"

#include <cmath>

#include "data/random.h"
#include "frontend/error.h"

namespace fabloop {
namespace {

/// Rotation by the angle |v| about v.
Eigen::Quaterniond exp_rotation(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  if (angle < 1e-12) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, v / angle));
}

Eigen::Vector3d normal_vector(Random& random) {
  const double x = random.normal();
  const double y = random.normal();
  const double z = random.normal();
  return {x, y, z};
}

void check(const DriftOptions& options) {
  const auto good = [](double value) { return std::isfinite(value) && value >= 0; };
  if (!good(options.scale_error) || options.scale_error >= 1 || !good(options.translation_noise) ||
      !good(options.rotation_noise_deg) || !good(options.heading_drift_deg_per_100m)) {
    throw InputError("odometry: the errors must be finite and not negative, and the scale's below 1");
  }
}

}  // namespace

std::vector<Pose> drifting_odometry(const std::vector<Pose>& world_from_camera, const DriftOptions& options) {
  check(options);
  Random random(options.seed, 0xD21F7);
  const double scale = 1 + random.sign() * options.scale_error;
  const double turn_rad_per_m = random.sign() * rad_from_deg(options.heading_drift_deg_per_100m) / 100;
  std::vector<Pose> odom_from_camera;
  for (std::size_t i = 0; i < world_from_camera.size(); ++i) {
    if (i == 0) {
      odom_from_camera.push_back(world_from_camera.front());
      continue;
    }
    Pose step = world_from_camera[i - 1].inverse() * world_from_camera[i];
    const double length_m = step.translation.norm();
    const Eigen::Vector3d up_in_camera = world_from_camera[i].rotation.conjugate() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d turn = turn_rad_per_m * length_m * up_in_camera;
    step.translation = scale * step.translation + options.translation_noise * length_m * normal_vector(random);
    step.rotation = step.rotation * exp_rotation(rad_from_deg(options.rotation_noise_deg) * normal_vector(random) + turn);
    odom_from_camera.push_back(odom_from_camera.back() * step);
  }
  return odom_from_camera;
}

}  // namespace fabloop
