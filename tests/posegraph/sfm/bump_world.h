// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "posegraph/sfm/reconstruction.h"

namespace fabloop::test {

/// A ground with a smooth hill in the middle and a pattern that repeats nowhere, seen by a few cameras from above: truth in
/// closed form.
struct BumpWorld {
  double hill_height = 2;  ///< 0: a plane.
  double hill_radius = 6;
  double flying_height = 20;
  int width = 120, height = 90;
  double focal = 100;

  double height_at(double x, double y) const { return hill_height * std::exp(-(x * x + y * y) / (hill_radius * hill_radius)); }

  /// Grey value of the ground, in [40, 215].
  static double pattern(double x, double y) {
    const double waves = std::sin(2.1 * x + 1.3 * std::sin(0.7 * y)) + std::sin(1.7 * y + 1.1 * std::sin(0.9 * x)) +
                         std::sin(3.3 * x - 2.9 * y) + std::sin(0.31 * x * y / (1 + 0.05 * std::abs(x * y)));
    return 127.5 + 21.8 * waves;
  }

  Camera camera() const {
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.fx = camera.fy = focal;
    camera.cx = 0.5 * (width - 1);
    camera.cy = 0.5 * (height - 1);
    return camera;
  }

  /// Looking straight down, image top to the north.
  static Pose looking_down(double x, double y, double z) {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(3.14159265358979323846, Eigen::Vector3d::UnitX())), {x, y, z}};
  }

  /// Where a pixel's ray meets the ground.
  Eigen::Vector3d seen_at(const Pose& world_from_camera, double column, double row) const {
    const Camera c = camera();
    const Eigen::Vector3d ray = world_from_camera.rotation * Eigen::Vector3d((column - c.cx) / c.fx, (row - c.cy) / c.fy, 1);
    double depth = flying_height;
    Eigen::Vector3d x;
    constexpr int kRounds = 15;  // contracts: the hill is far less steep than the rays
    for (int round = 0; round < kRounds; ++round) {
      x = world_from_camera.translation + depth * ray;
      depth += (x.z() - height_at(x.x(), x.y())) / -ray.z();
    }
    return x;
  }

  cv::Mat3b photograph(const Pose& world_from_camera, double gain = 1) const {
    cv::Mat3b image(height, width);
    for (int row = 0; row < height; ++row) {
      for (int column = 0; column < width; ++column) {
        const Eigen::Vector3d x = seen_at(world_from_camera, column, row);
        const auto grey = cv::saturate_cast<unsigned char>(gain * pattern(x.x(), x.y()));
        image(row, column) = {grey, grey, grey};
      }
    }
    return image;
  }

  /// Cameras on a lattice, photographs in `folder`, and points of the ground without error.
  Reconstruction reconstruction(const std::filesystem::path& folder, double gain_step = 0) const {
    Reconstruction result;
    result.cameras = {camera()};
    result.unit = LengthUnit::Metres;
    for (int i = 0; i < 9; ++i) {
      const Pose pose = looking_down(5.0 * (i % 3 - 1), 4.0 * (i / 3 - 1), flying_height);
      const std::filesystem::path path = folder / ("image" + std::to_string(i) + ".png");
      cv::imwrite(path.string(), photograph(pose, 1 + gain_step * (i % 2)));
      result.images.push_back({static_cast<std::size_t>(i), path, i * std::int64_t{1'000'000'000}, 0, pose});
    }
    for (double y = -12; y <= 12; y += 1.5) {
      for (double x = -15; x <= 15; x += 1.5) {
        ScenePoint point;
        point.x_in_world = {x, y, height_at(x, y)};
        result.points.push_back(point);
      }
    }
    return result;
  }
};

}  // namespace fabloop::test
