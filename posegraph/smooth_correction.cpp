// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/smooth_correction.h"

#include <algorithm>
#include <cmath>

#include "frontend/error.h"

namespace fabloop {

const Pose& SmoothCorrection::update(const Pose& map_from_odom, const Pose& odom_from_body, double elapsed_s) {
  if (!(elapsed_s >= 0.0) || !std::isfinite(elapsed_s)) {
    throw InputError("smooth correction: the elapsed time must be finite and not negative; give seconds since the last call");
  }
  const Pose map_from_body = map_from_odom_ * odom_from_body;
  const Pose correction = map_from_body.inverse() * (map_from_odom * odom_from_body);
  const double distance_m = correction.translation.norm();
  const double angle_rad = rotation_angle(correction.rotation);
  // Both end together, so that the way is straight.
  double share = 1.0;
  if (distance_m > limits_.speed_m_s * elapsed_s) share = std::min(share, limits_.speed_m_s * elapsed_s / distance_m);
  if (angle_rad > limits_.turn_rate_rad_s * elapsed_s) share = std::min(share, limits_.turn_rate_rad_s * elapsed_s / angle_rad);
  if (share == 1.0) {
    map_from_odom_ = map_from_odom;
    return map_from_odom_;
  }
  const Pose part{Eigen::Quaterniond::Identity().slerp(share, correction.rotation), share * correction.translation};
  map_from_odom_ = map_from_body * part * odom_from_body.inverse();
  return map_from_odom_;
}

}  // namespace fabloop
