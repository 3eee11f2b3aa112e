// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <vector>

#include "frontend/geometry/geo_position.h"
#include "frontend/sequence/sequence.h"

namespace fabloop {

/// Reads lines `filename,latitude_deg,longitude_deg,altitude_m` (`#` comments): one position a frame of the sequence where the
/// file names its image. Throws InputError naming file and line, and when the file names none of the images.
std::vector<std::optional<GeoPosition>> read_gps(const std::filesystem::path& path, const Sequence& sequence);

/// Positions that the images' EXIF tells.
std::vector<std::optional<GeoPosition>> gps_from_exif(const Sequence& sequence);

/// Positions of frames in one east-north-up frame about their middle (medians), so that a wild one does not tilt it.
struct LocalPositions {
  GeoPosition origin;
  std::vector<std::optional<Eigen::Vector3d>> east_north_up_m;
};

LocalPositions local_positions(const std::vector<std::optional<GeoPosition>>& positions);

}  // namespace fabloop
