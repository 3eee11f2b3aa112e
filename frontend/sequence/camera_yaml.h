// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "frontend/geometry/camera.h"

namespace fabloop {

/// Reads a camera's calibration from YAML in any of the forms that the usual tools write:
/// - ROS camera_info: `image_width`, `image_height`, `camera_matrix{data}`, `distortion_model` (plumb_bob,
///   rational_polynomial, equidistant), `distortion_coefficients{data}`; also the message's `width`, `height`, `K`, `D` or
///   `k`, `d`;
/// - OpenCV's FileStorage (`%YAML:1.0`, `!!opencv-matrix`), with the same names, `cameraMatrix` and `distCoeffs`, or `K` and `D`;
/// - Kalibr's camchain (its `cam0`) and EuRoC's sensor.yaml: `resolution`, `intrinsics`, `distortion_model` (radtan,
///   radial-tangential, equidistant), `distortion_coeffs`.
///
/// Without `distortion_model` the distortion is OpenCV's radial-tangential one. Throws InputError naming the file (and the line
/// where it has one) when it cannot be read, lacks something, or its numbers cannot be a camera's.
Camera read_camera_yaml(const std::filesystem::path& path);

}  // namespace fabloop
