// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fabloop {

/// A place on Earth (WGS 84).
struct GeoPosition {
  double latitude_deg = 0;
  double longitude_deg = 0;
  double altitude_m = 0;  ///< Above the ellipsoid, or above whatever its source counts from: never mixed.
};

}  // namespace fabloop
