// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>

#include "frontend/geometry/camera.h"
#include "frontend/geometry/geo_position.h"

namespace fabloop {

/// A guess at an image's camera from its EXIF: the focal length with either the sensor's width (focal-plane resolution) or the
/// 35-mm equivalent, square pixels, the principal point in the middle, no distortion. `width` and `height` are the image's
/// pixels, which may be fewer than the sensor's. Off by a few percent as a rule, which bends a long trajectory. None when the
/// file has no such EXIF.
std::optional<Camera> camera_from_exif(const std::filesystem::path& image_path, int width, int height);

/// Where an image's EXIF says that it was taken; none when it does not say, altitude included.
std::optional<GeoPosition> position_from_exif(const std::filesystem::path& image_path);

}  // namespace fabloop
