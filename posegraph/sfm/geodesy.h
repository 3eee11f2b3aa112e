// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "frontend/geometry/geo_position.h"

namespace fabloop {

/// WGS 84 coordinates of a point in the local east-north-up frame about `origin`, exactly (Earth's curvature included).
GeoPosition geo_from_local(const GeoPosition& origin, const Eigen::Vector3d& x_in_local);

/// Local east-north-up coordinates about `origin` of a place on Earth; the inverse of geo_from_local().
Eigen::Vector3d local_from_geo(const GeoPosition& origin, const GeoPosition& place);

/// The map grid (UTM, or UPS near the poles) about an origin. Near it, grid coordinates are
/// (easting, northing) + scale * R(convergence) * (east, north), with errors of a few centimetres per kilometre and kilometre.
struct MapGrid {
  int epsg = 0;  ///< 326zz north, 327zz south; 32661 and 32761 at the poles.
  double easting_m = 0;
  double northing_m = 0;
  double scale = 1;            ///< Metres on the grid per metre on the ground.
  double convergence_deg = 0;  ///< Grid north clockwise of true north: turn local vectors counter-clockwise by it.
};

/// The map grid at `origin`, in the standard zone of its place. Throws InputError when the origin is no place on Earth.
MapGrid map_grid_at(const GeoPosition& origin);

}  // namespace fabloop
