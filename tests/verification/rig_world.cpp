// SPDX-License-Identifier: BSD-3-Clause
#include "tests/verification/rig_world.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

namespace fabloop::testing_support {
namespace {

constexpr double kHalfWidth = 1.2;  ///< Tangent of half the picture's angle.
constexpr double kHalfHeight = 0.8;

class Rig {
 public:
  Rig(const RigWorldOptions& options, std::uint64_t seed) : options_(options), random_(seed) {
    for (std::size_t i = 0; i < options.num_cameras; ++i) {
      const double angle = 2 * kPi * static_cast<double>(i) / static_cast<double>(options.num_cameras);
      const Eigen::Vector3d outwards(std::cos(angle), std::sin(angle), 0);
      Eigen::Matrix3d rotation;
      rotation << outwards.cross(Eigen::Vector3d::UnitZ()), -Eigen::Vector3d::UnitZ(), outwards;
      // A little up and down, so that not all cameras' origins are in one plane.
      const Eigen::Vector3d origin = options.ring_radius * (outwards + 0.4 * std::sin(3 * angle + 1) * Eigen::Vector3d::UnitZ());
      body_from_camera_.push_back({Eigen::Quaterniond(rotation), origin});
    }
  }

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Eigen::Vector3d normal3() { return {normal_(random_), normal_(random_), normal_(random_)}; }
  std::size_t random_camera() { return random_() % body_from_camera_.size(); }
  std::mt19937_64& random() { return random_; }

  Eigen::Vector3d random_point_of(std::size_t camera) {
    const Eigen::Vector3d pixel_ray(uniform(-kHalfWidth, kHalfWidth), uniform(-kHalfHeight, kHalfHeight), 1);
    return body_from_camera_[camera] * Eigen::Vector3d(uniform(3, 10) * pixel_ray);
  }

  /// One of the cameras that see the point.
  std::optional<std::size_t> camera_that_sees(const Eigen::Vector3d& x_in_body) {
    std::vector<std::size_t> seeing;
    for (std::size_t i = 0; i < body_from_camera_.size(); ++i) {
      const Eigen::Vector3d x = body_from_camera_[i].inverse() * x_in_body;
      if (x.z() > 0.5 && std::abs(x.x()) < kHalfWidth * x.z() && std::abs(x.y()) < kHalfHeight * x.z()) seeing.push_back(i);
    }
    if (seeing.empty()) return std::nullopt;
    return seeing[random_() % seeing.size()];
  }

  RigRay ray_to(const Eigen::Vector3d& x_in_body, std::size_t camera) {
    const Eigen::Vector3d& origin = body_from_camera_[camera].translation;
    return {origin, rotation_from_vector(options_.noise_rad * normal3()) * (x_in_body - origin).normalized()};
  }

 private:
  RigWorldOptions options_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::vector<Pose> body_from_camera_;
};

}  // namespace

RigWorld make_rig_world(const RigWorldOptions& options) {
  Rig rig(options, options.seed);
  RigWorld world;
  world.match_from_query = {rotation_from_vector(options.rotation_rad * rig.normal3().normalized()),
                            options.baseline * rig.normal3().normalized()};
  const auto num_outliers = static_cast<std::size_t>(std::lround(options.outlier_ratio * static_cast<double>(options.num_data)));
  while (world.pairs.size() < options.num_data) {
    const std::size_t query_camera = rig.random_camera();
    const Eigen::Vector3d x_in_query = rig.random_point_of(query_camera);
    const Eigen::Vector3d x_in_match = world.match_from_query * x_in_query;
    const auto match_camera = rig.camera_that_sees(x_in_match);
    if (!match_camera || (options.within_cameras && *match_camera != query_camera)) continue;
    const bool is_outlier = world.pairs.size() < num_outliers;
    const Eigen::Vector3d seen = is_outlier ? rig.random_point_of(query_camera) : x_in_query;
    world.pairs.push_back({rig.ray_to(seen, query_camera), rig.ray_to(x_in_match, *match_camera)});
    world.points_and_rays.push_back({x_in_match, world.pairs.back().query});
  }
  std::shuffle(world.pairs.begin(), world.pairs.end(), rig.random());
  std::shuffle(world.points_and_rays.begin(), world.points_and_rays.end(), rig.random());
  return world;
}

}  // namespace fabloop::testing_support
