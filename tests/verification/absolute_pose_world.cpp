// SPDX-License-Identifier: BSD-3-Clause
#include "tests/verification/absolute_pose_world.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace fabloop::testing_support {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }

Eigen::Vector3d random_pixel_ray(Random& random) {
  return {uniform(random, -320, 320) / kFocalPx, uniform(random, -240, 240) / kFocalPx, 1.0};
}

}  // namespace

AbsolutePoseWorld make_absolute_pose_world(const AbsolutePoseWorldOptions& options) {
  Random random(options.seed);
  std::normal_distribution<double> normal;
  const auto normal3 = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
  AbsolutePoseWorld world;
  world.world_from_camera = {rotation_from_vector(normal3().normalized() * uniform(random, 0, kPi)), 20.0 * normal3()};
  const auto num_outliers = static_cast<std::size_t>(std::lround(options.outlier_ratio * static_cast<double>(options.num_data)));
  for (std::size_t i = 0; i < options.num_data; ++i) {
    const Eigen::Vector3d pixel_ray = random_pixel_ray(random);
    const double depth = options.planar ? 8.0 / (1.0 + 0.3 * pixel_ray.x() - 0.2 * pixel_ray.y()) : uniform(random, 4, 12);
    const Eigen::Vector3d noise(normal(random), normal(random), 0);
    const Eigen::Vector3d turn = options.noise_rad * normal3();  // the part along the ray does nothing
    const bool is_outlier = i < num_outliers;
    const Eigen::Vector3d seen =
        is_outlier ? random_pixel_ray(random) : Eigen::Vector3d(pixel_ray + options.noise_px / kFocalPx * noise);
    world.data.push_back(
        {world.world_from_camera * Eigen::Vector3d(depth * pixel_ray), rotation_from_vector(turn) * seen.normalized()});
  }
  std::shuffle(world.data.begin(), world.data.end(), random);
  return world;
}

}  // namespace fabloop::testing_support
