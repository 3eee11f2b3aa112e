// SPDX-License-Identifier: BSD-3-Clause
#include "tests/verification/two_view_world.h"

#include <algorithm>
#include <random>

namespace fabloop::testing_support {
namespace {

using Random = std::mt19937_64;

double uniform_between(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Eigen::Vector3d random_direction(Random& random) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
}

Eigen::Vector3d random_point(Random& random, const Camera& camera, const TwoViewOptions& options) {
  if (options.fills_image) {
    const Eigen::Vector2d pixel(uniform_between(random, 0, camera.width - 1), uniform_between(random, 0, camera.height - 1));
    return uniform_between(random, 4, 8) * bearings(camera, {pixel}).front().hnormalized().homogeneous();
  }
  Eigen::Vector3d point(uniform_between(random, -5, 5), uniform_between(random, -4, 4), uniform_between(random, 8, 14));
  if (options.planar) point.z() = 11 + 0.15 * point.x() - 0.1 * point.y();
  return point;
}

Eigen::Vector2d noisy_pixel(Random& random, const Camera& camera, const Eigen::Vector3d& x_in_camera, double noise_px) {
  std::normal_distribution<double> normal(0, 1);
  return *project(camera, x_in_camera) + noise_px * Eigen::Vector2d(normal(random), normal(random));
}

cv::KeyPoint keypoint(const Eigen::Vector2d& pixel) {
  return {static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), 3.0F};
}

cv::Mat1f random_descriptors(Random& random, int count) {
  std::normal_distribution<float> normal;
  cv::Mat1f descriptors(count, 64);
  for (float& value : descriptors) value = normal(random);
  return descriptors;
}

/// Best score first; as they came without scores.
std::vector<std::size_t> order(const std::vector<bool>& is_outlier, bool scored, std::uint64_t seed) {
  constexpr double kGap = 2;
  Random random(seed ^ 0x5c03ed);
  std::normal_distribution<double> normal;
  std::vector<double> scores;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < is_outlier.size(); ++i) {
    scores.push_back(scored ? normal(random) + (is_outlier[i] ? kGap : 0.0) : 0.0);
    indices.push_back(i);
  }
  std::stable_sort(indices.begin(), indices.end(), [&](std::size_t a, std::size_t b) { return scores[a] < scores[b]; });
  return indices;
}

}  // namespace

Camera test_camera() { return {640, 480, 500, 500, 319.5, 239.5, DistortionModel::Radtan, {}}; }

TwoViews make_two_views(const TwoViewOptions& options) {
  Random random(options.seed);
  const Camera camera = test_camera();
  TwoViews world;
  Eigen::Vector3d direction = random_direction(random);
  direction.z() *= 0.3;
  world.match_from_query = {rotation_from_vector(0.2 * random_direction(random)), options.baseline * direction.normalized()};
  const Pose query_from_match = world.match_from_query.inverse();
  Features query, match;
  std::vector<std::optional<Eigen::Vector3d>> points;
  std::vector<bool> is_outlier;
  while (static_cast<int>(points.size()) < options.num_points) {
    const Eigen::Vector3d x_in_match = random_point(random, camera, options);
    const Eigen::Vector3d x_in_query = query_from_match * x_in_match;
    if (x_in_query.z() < 1) continue;
    query.keypoints.push_back(keypoint(noisy_pixel(random, camera, x_in_query, options.noise_px)));
    match.keypoints.push_back(keypoint(noisy_pixel(random, camera, x_in_match, options.noise_px)));
    is_outlier.push_back(uniform_between(random, 0, 1) < options.outlier_ratio);
    if (is_outlier.back()) query.keypoints.back() = keypoint({uniform_between(random, 0, 639), uniform_between(random, 0, 479)});
    points.emplace_back((1 + options.depth_noise * uniform_between(random, -1, 1)) * x_in_match);
  }
  query.descriptors = random_descriptors(random, options.num_points);
  match.descriptors = query.descriptors.clone();
  world.query = make_view(20, camera, query);
  world.match = make_view(3, camera, match);
  if (options.with_points) world.match.points_in_camera = points;
  for (const std::size_t i : order(is_outlier, options.scored, options.seed)) {
    world.pairs.push_back({world.query.rays[i], world.match.rays[i]});
  }
  return world;
}

}  // namespace fabloop::testing_support
