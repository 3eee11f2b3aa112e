// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "frontend/geometry/camera.h"

namespace fabloop {

/// COLMAP's pixel centres lie at (0.5, 0.5), ours at integers.
inline constexpr double kColmapHalfPixel = 0.5;

/// A camera as COLMAP writes it: model name and parameters.
struct ColmapCamera {
  std::string model;
  std::vector<double> parameters;
};

/// Our camera of COLMAP's; the size is taken as given. None for a model that we have no equal of, or a wrong count of parameters.
std::optional<Camera> camera_from_colmap(std::string_view model, int width, int height, const std::vector<double>& parameters);

/// COLMAP's camera of ours, by the simplest of its models that holds all coefficients.
ColmapCamera colmap_from_camera(const Camera& camera);

}  // namespace fabloop
