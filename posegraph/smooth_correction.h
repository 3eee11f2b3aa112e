// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frontend/geometry/pose.h"

namespace fabloop {

/// How fast a host lets its pose be corrected.
struct CorrectionLimits {
  double speed_m_s = 0.5;        ///< What a controller swallows without a jolt.
  double turn_rate_rad_s = 0.2;  ///< As `speed_m_s`.
};

/// map_from_odom without jumps: after a loop, the body's pose in the map glides to where it should be. The limits hold where the
/// body is, however far the origin of the odometry.
class SmoothCorrection {
 public:
  explicit SmoothCorrection(const CorrectionLimits& limits = {}) : limits_(limits) {}

  /// What to put before the odometry now, `elapsed_s` after the last call, when `map_from_odom` is right and the body is at
  /// `odom_from_body`. Throws InputError for a negative or infinite time.
  const Pose& update(const Pose& map_from_odom, const Pose& odom_from_body, double elapsed_s);

  /// What update() returned last; the identity before.
  const Pose& map_from_odom() const { return map_from_odom_; }

 private:
  CorrectionLimits limits_;
  Pose map_from_odom_;
};

}  // namespace fabloop
