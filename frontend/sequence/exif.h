// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "frontend/geometry/camera.h"
#include "frontend/geometry/geo_position.h"

namespace fabloop {

/// A guess at an image's camera from its EXIF: the focal length with either the sensor's width (focal-plane resolution) or the
/// 35-mm equivalent, square pixels, the principal point in the middle, no distortion. `width` and `height` are the image's
/// pixels, which may be fewer than the sensor's. Off by a few percent as a rule, which bends a long trajectory. None when the
/// file has no such EXIF.
std::optional<Camera> camera_from_exif(const std::filesystem::path& image_path, int width, int height);

/// Which camera took an image, and how far it was zoomed.
struct CameraLabel {
  std::string make, model;         ///< As written, without spaces at the end.
  std::optional<double> focal_mm;  ///< Of the lens, where it is told.
};

/// "Canon PowerShot SX260 HS at 4.5 mm".
std::string to_string(const CameraLabel& label);

/// What an image's EXIF says of its camera; none when it names neither make nor model.
std::optional<CameraLabel> camera_label_from_exif(const std::filesystem::path& image_path);

/// Where an image's EXIF says that it was taken; none when it does not say, altitude included.
std::optional<GeoPosition> position_from_exif(const std::filesystem::path& image_path);

}  // namespace fabloop
