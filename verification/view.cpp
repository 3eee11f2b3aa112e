// SPDX-License-Identifier: BSD-3-Clause
#include "verification/view.h"

#include <algorithm>
#include <utility>

namespace fabloop {

View make_view(std::size_t frame, const Camera& camera, Features features) {
  std::vector<Eigen::Vector2d> pixels;
  pixels.reserve(features.keypoints.size());
  for (const auto& keypoint : features.keypoints) pixels.emplace_back(keypoint.pt.x, keypoint.pt.y);
  View view;
  view.frame = frame;
  view.camera = camera;
  view.rays = bearings(camera, pixels);
  view.points_in_camera.resize(pixels.size());
  view.features = std::move(features);
  return view;
}

std::size_t count_points(const View& view) {
  return static_cast<std::size_t>(
      std::count_if(view.points_in_camera.begin(), view.points_in_camera.end(), [](const auto& point) { return point.has_value(); }));
}

}  // namespace fabloop
