// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/colmap_camera.h"

#include <algorithm>
#include <array>

namespace fabloop {
namespace {

/// How a model's parameters lie: focal lengths (1: both alike), the principal point, then coefficients.
struct ModelLayout {
  std::string_view name;
  std::size_t num_focals;
  std::size_t num_coefficients;
  DistortionModel distortion;
};

constexpr std::array<ModelLayout, 9> kModels{{{"SIMPLE_PINHOLE", 1, 0, DistortionModel::Radtan},
                                              {"PINHOLE", 2, 0, DistortionModel::Radtan},
                                              {"SIMPLE_RADIAL", 1, 1, DistortionModel::Radtan},
                                              {"RADIAL", 1, 2, DistortionModel::Radtan},
                                              {"OPENCV", 2, 4, DistortionModel::Radtan},
                                              {"FULL_OPENCV", 2, 8, DistortionModel::Radtan},
                                              {"OPENCV_FISHEYE", 2, 4, DistortionModel::Equidistant},
                                              {"SIMPLE_RADIAL_FISHEYE", 1, 1, DistortionModel::Equidistant},
                                              {"RADIAL_FISHEYE", 1, 2, DistortionModel::Equidistant}}};

}  // namespace

std::optional<Camera> camera_from_colmap(std::string_view model, int width, int height, const std::vector<double>& parameters) {
  const auto* layout = std::find_if(kModels.begin(), kModels.end(), [&](const ModelLayout& m) { return m.name == model; });
  if (layout == kModels.end() || parameters.size() != layout->num_focals + 2 + layout->num_coefficients) return std::nullopt;
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = parameters[0];
  camera.fy = parameters[layout->num_focals - 1];
  camera.cx = parameters[layout->num_focals] - kColmapHalfPixel;
  camera.cy = parameters[layout->num_focals + 1] - kColmapHalfPixel;
  camera.distortion_model = layout->distortion;
  camera.distortion.assign(parameters.begin() + static_cast<std::ptrdiff_t>(layout->num_focals) + 2, parameters.end());
  // Both keep k1 k2 p1 p2 k3 ... (radial-tangential) and k1 k2 k3 k4 (fisheye); ours wants four at least.
  if (!camera.distortion.empty() && camera.distortion.size() < 4) camera.distortion.resize(4, 0.0);
  return camera;
}

ColmapCamera colmap_from_camera(const Camera& camera) {
  ColmapCamera result;
  result.parameters = {camera.fx, camera.fy, camera.cx + kColmapHalfPixel, camera.cy + kColmapHalfPixel};
  std::vector<double> coefficients = camera.distortion;
  if (camera.distortion_model == DistortionModel::Equidistant) {
    result.model = "OPENCV_FISHEYE";
    coefficients.resize(4, 0.0);
  } else if (std::all_of(coefficients.begin(), coefficients.end(), [](double k) { return k == 0; })) {
    result.model = "PINHOLE";
    coefficients.clear();
  } else if (std::all_of(coefficients.begin() + std::min<std::ptrdiff_t>(4, std::ssize(coefficients)), coefficients.end(),
                         [](double k) { return k == 0; })) {
    result.model = "OPENCV";
    coefficients.resize(4, 0.0);
  } else {
    result.model = "FULL_OPENCV";
    coefficients.resize(8, 0.0);
  }
  result.parameters.insert(result.parameters.end(), coefficients.begin(), coefficients.end());
  return result;
}

}  // namespace fabloop
