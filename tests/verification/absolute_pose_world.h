// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/pose/absolute_pose.h"

namespace fabloop::testing_support {

inline constexpr double kFocalPx = 500;  ///< Of a 640 x 480 pinhole.

struct AbsolutePoseWorldOptions {
  std::size_t num_data = 200;
  double outlier_ratio = 0;  ///< Exactly this share, in random places.
  double noise_px = 0;       ///< Standard deviation of each pixel coordinate.
  double noise_rad = 0;      ///< Standard deviation of a ray's angle about each axis across it, the same in the whole picture.
  bool planar = false;       ///< All points on one slanted plane.
  std::uint64_t seed = 1;
};

/// A pinhole anywhere in any attitude, points 4 to 12 m in front of it in its picture; outliers see random pixels.
struct AbsolutePoseWorld {
  Pose world_from_camera;
  std::vector<PointRay> data;
};

AbsolutePoseWorld make_absolute_pose_world(const AbsolutePoseWorldOptions& options);

}  // namespace fabloop::testing_support
