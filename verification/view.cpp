// SPDX-License-Identifier: BSD-3-Clause
#include "verification/view.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fabloop {
namespace {

/// What two neighbours' rotation is uncertain by; over the parallax it is the relative error of a depth.
constexpr double kAngleSigmaRad = 0.005;

}  // namespace

View make_view(std::size_t frame, const Camera& camera, Features features) {
  std::vector<Eigen::Vector2d> pixels;
  pixels.reserve(features.keypoints.size());
  for (const auto& keypoint : features.keypoints) pixels.emplace_back(keypoint.pt.x, keypoint.pt.y);
  View view;
  view.frame = frame;
  view.camera = camera;
  view.rays = bearings(camera, pixels);
  view.points_in_camera.resize(pixels.size());
  view.point_weights.resize(pixels.size(), 0.0);
  view.features = std::move(features);
  return view;
}

double feature_focal_px(const View& view) { return view.camera.focal_px() / view.features.pixel_size; }

void add_point_measurement(View& view, std::size_t i, const Eigen::Vector3d& x_in_camera, double parallax_rad) {
  constexpr double kSigmas = 3.0;
  auto& known = view.points_in_camera[i];
  double& weight = view.point_weights[i];
  const double new_weight = parallax_rad * parallax_rad;
  if (!known) {
    known = x_in_camera;
    weight = new_weight;
    return;
  }
  const double depth = x_in_camera.norm();
  const double known_depth = known->norm();
  const double allowed = kSigmas * kAngleSigmaRad * std::sqrt(1.0 / weight + 1.0 / new_weight);
  if (std::abs(depth - known_depth) > allowed * 0.5 * (depth + known_depth)) {
    known.reset();
    weight = 0;
  } else {
    *known = (weight * *known + new_weight * x_in_camera) / (weight + new_weight);
    weight += new_weight;
  }
}

void set_known_point(View& view, std::size_t i, const Eigen::Vector3d& x_in_camera, double relative_sigma) {
  const double parallax_rad = kAngleSigmaRad / relative_sigma;
  view.points_in_camera[i] = x_in_camera;
  view.point_weights[i] = parallax_rad * parallax_rad;
}

void clear_points(View& view) {
  std::fill(view.points_in_camera.begin(), view.points_in_camera.end(), std::nullopt);
  std::fill(view.point_weights.begin(), view.point_weights.end(), 0.0);
  view.unit_sigma = 0;
}

std::size_t count_points(const View& view) {
  return static_cast<std::size_t>(std::count_if(view.points_in_camera.begin(), view.points_in_camera.end(),
                                                [](const auto& point) { return point.has_value(); }));
}

}  // namespace fabloop
