// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/rig/rig_pose.h"

namespace fabloop::testing_support {

struct RigWorldOptions {
  std::size_t num_data = 200;
  std::size_t num_cameras = 4;  ///< In a ring, looking outwards, each with a picture of 100 x 80 degrees.
  double ring_radius = 0.5;     ///< Metres, of the ring of cameras; the points are 3 to 10 m away.
  double baseline = 1.5;        ///< Metres between the two places of the rig.
  double rotation_rad = 0.3;    ///< Between its two attitudes.
  bool within_cameras = false;  ///< Every pair is seen by the same camera twice.
  double outlier_ratio = 0;     ///< Exactly this share, in random places.
  double noise_rad = 0;         ///< Standard deviation of every ray's angle about each axis across it.
  std::uint64_t seed = 1;
};

/// A rig of cameras at two places among random points, and the rays of what it sees from both; outliers see random directions.
struct RigWorld {
  Pose match_from_query;
  std::vector<RigRayPair> pairs;
  std::vector<RigPointRay> points_and_rays;  ///< Points in the match's body, rays of the query.
};

RigWorld make_rig_world(const RigWorldOptions& options);

}  // namespace fabloop::testing_support
