// SPDX-License-Identifier: BSD-3-Clause
#include "data/renderer.h"

#include <algorithm>
#include <cmath>

namespace fabloop {
namespace {

/// Bilinear look-up in one level of the texture. `x`, `y` in pixels of level 0.
Eigen::Vector3f sample_level(const cv::Mat3b& level, float x, float y, float scale) {
  const float px = std::clamp(x * scale, 0.0F, static_cast<float>(level.cols) - 1.01F);
  const float py = std::clamp(y * scale, 0.0F, static_cast<float>(level.rows) - 1.01F);
  const int ix = static_cast<int>(px);
  const int iy = static_cast<int>(py);
  const float fx = px - static_cast<float>(ix);
  const float fy = py - static_cast<float>(iy);
  const cv::Vec3b* below = level[iy] + ix;
  const cv::Vec3b* above = level[iy + 1] + ix;
  Eigen::Vector3f colour;
  for (int channel = 0; channel < 3; ++channel) {
    const float a = static_cast<float>(below[0][channel]) * (1 - fx) + static_cast<float>(below[1][channel]) * fx;
    const float b = static_cast<float>(above[0][channel]) * (1 - fx) + static_cast<float>(above[1][channel]) * fx;
    colour[channel] = a * (1 - fy) + b * fy;
  }
  return colour;
}

/// Colour of the texture at world (x, y), averaged over about `footprint_m`.
cv::Vec3b sample_texture(const World& world, double x, double y, double footprint_m) {
  const auto px = static_cast<float>((x - world.area.min.x()) / world.texture_m_per_px);
  const auto py = static_cast<float>((y - world.area.min.y()) / world.texture_m_per_px);
  const auto max_level = static_cast<float>(world.texture.size()) - 1.0F;
  const float level = std::clamp(static_cast<float>(std::log2(footprint_m / world.texture_m_per_px)), 0.0F, max_level);
  const auto finer = static_cast<std::size_t>(level);
  const float blend = level - static_cast<float>(finer);
  const float scale = 1.0F / static_cast<float>(1U << finer);
  Eigen::Vector3f colour = sample_level(world.texture[finer], px, py, scale);
  if (blend > 0.01F) colour += blend * (sample_level(world.texture[finer + 1], px, py, 0.5F * scale) - colour);
  const auto rounded = [](float value) { return static_cast<uchar>(value + 0.5F); };
  return {rounded(colour[0]), rounded(colour[1]), rounded(colour[2])};
}

std::vector<Eigen::Vector3d> rays_of(const Camera& camera) {
  std::vector<Eigen::Vector2d> pixels;
  pixels.reserve(static_cast<std::size_t>(camera.width) * camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) pixels.emplace_back(x, y);
  }
  return bearings(camera, pixels);
}

}  // namespace

Renderer::Renderer(const World& world, const Camera& camera) : world_(world), camera_(camera) {
  validate(camera, "renderer");
  rays_ = rays_of(camera);
}

RenderedView Renderer::render(const Pose& world_from_camera) const {
  RenderedView view;
  view.image.create(camera_.height, camera_.width);
  view.depth.create(camera_.height, camera_.width);
  for (int row = 0; row < camera_.height; ++row) render_row(row, world_from_camera, view);
  return view;
}

void Renderer::render_row(int row, const Pose& world_from_camera, RenderedView& view) const {
  const Eigen::Matrix3d rotation = world_from_camera.rotation.toRotationMatrix();
  const Eigen::Vector3d& centre = world_from_camera.translation;
  const cv::Vec3b kHaze(206, 200, 192);
  for (int col = 0; col < camera_.width; ++col) {
    const Eigen::Vector3d& ray_in_camera = rays_[static_cast<std::size_t>(row) * camera_.width + col];
    const Eigen::Vector3d ray = rotation * ray_in_camera;
    const auto distance = intersect(world_.surface, centre, ray);
    if (!distance) {
      view.image(row, col) = kHaze;
      view.depth(row, col) = 0;
      continue;
    }
    const Eigen::Vector3d point = centre + *distance * ray;
    view.image(row, col) = sample_texture(world_, point.x(), point.y(), *distance / camera_.focal_px());
    view.depth(row, col) = static_cast<float>(*distance * ray_in_camera.z());
  }
}

}  // namespace fabloop
