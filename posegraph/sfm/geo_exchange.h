// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "posegraph/sfm/loop_link.h"
#include "posegraph/sfm/reconstruction.h"

namespace fabloop {

/// Writes OpenDroneMap's `geo.txt`: `EPSG:4326`, then `image longitude latitude altitude`. The reconstruction must have an
/// origin.
void write_geo_txt(const std::filesystem::path& path, const Reconstruction& reconstruction);

/// Writes the cameras' track as a line and the loops as lines between the frames they join, for Google Earth and GIS. Loops of
/// frames without a place are left out. The reconstruction must have an origin.
void write_track_kml(const std::filesystem::path& path, const Reconstruction& reconstruction, const std::vector<LoopLink>& loops,
                     const std::string& name);

/// The same as GeoJSON (RFC 7946): a LineString feature with `kind` "track", and one a loop with `kind` "loop", `query`, `match`.
void write_track_geojson(const std::filesystem::path& path, const Reconstruction& reconstruction,
                         const std::vector<LoopLink>& loops, const std::string& name);

}  // namespace fabloop
