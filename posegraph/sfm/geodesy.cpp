// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/geodesy.h"

#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/UTMUPS.hpp>
#include <cmath>
#include <string>

#include "frontend/error.h"

namespace fabloop {
namespace {

GeographicLib::LocalCartesian frame_at(const GeoPosition& origin) {
  return {origin.latitude_deg, origin.longitude_deg, origin.altitude_m, GeographicLib::Geocentric::WGS84()};
}

}  // namespace

GeoPosition geo_from_local(const GeoPosition& origin, const Eigen::Vector3d& x_in_local) {
  GeoPosition place;
  frame_at(origin).Reverse(x_in_local.x(), x_in_local.y(), x_in_local.z(), place.latitude_deg, place.longitude_deg,
                           place.altitude_m);
  return place;
}

Eigen::Vector3d local_from_geo(const GeoPosition& origin, const GeoPosition& place) {
  Eigen::Vector3d x;
  frame_at(origin).Forward(place.latitude_deg, place.longitude_deg, place.altitude_m, x.x(), x.y(), x.z());
  return x;
}

MapGrid map_grid_at(const GeoPosition& origin) {
  if (!(std::abs(origin.latitude_deg) <= 90 && std::abs(origin.longitude_deg) <= 360 && std::isfinite(origin.altitude_m))) {
    throw InputError("the origin (latitude " + std::to_string(origin.latitude_deg) + ", longitude " +
                     std::to_string(origin.longitude_deg) + ") is no place on Earth; are latitude and longitude swapped?");
  }
  MapGrid grid;
  int zone = 0;
  bool is_north = true;
  GeographicLib::UTMUPS::Forward(origin.latitude_deg, origin.longitude_deg, zone, is_north, grid.easting_m, grid.northing_m,
                                 grid.convergence_deg, grid.scale);
  grid.epsg = GeographicLib::UTMUPS::EncodeEPSG(zone, is_north);
  return grid;
}

}  // namespace fabloop
