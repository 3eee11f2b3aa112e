// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "frontend/geometry/camera.h"

namespace fabloop {

/// Writes a calibration as ROS camera_info YAML. Throws InputError for a lens other than plumb-bob, and when it cannot be
/// written.
void write_camera_yaml(const std::filesystem::path& path, const Camera& camera);

/// Writes an image as its extension says, with cv::imwrite's parameters. Throws InputError when it cannot be written.
void write_image(const std::filesystem::path& path, const cv::Mat& image, const std::vector<int>& parameters = {});

}  // namespace fabloop
