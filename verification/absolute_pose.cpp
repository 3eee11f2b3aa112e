// SPDX-License-Identifier: BSD-3-Clause
#include "verification/absolute_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opengv/absolute_pose/CentralAbsoluteAdapter.hpp>
#include <opengv/absolute_pose/methods.hpp>

#include "verification/levenberg_marquardt.h"
#include "verification/ransac.h"

namespace fabloop {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Angles between rays and points with respect to (translation in the world, rotation in the camera), radians.
NormalEquations<6> linearise(std::span<const PointRay> data, std::span<const std::size_t> indices,
                             const Pose& world_from_camera) {
  const Eigen::Matrix3d camera_from_world_rotation = world_from_camera.rotation.conjugate().toRotationMatrix();
  NormalEquations<6> normal;
  for (const std::size_t i : indices) {
    const Eigen::Vector3d x_in_camera = camera_from_world_rotation * (data[i].point_in_world - world_from_camera.translation);
    const double distance = x_in_camera.norm();
    const Eigen::Vector3d direction = x_in_camera / distance;
    const Eigen::Vector3d& ray = data[i].ray_in_camera;
    // The two components across the ray of the point's direction.
    Eigen::Matrix<double, 2, 3> across;
    across.row(0) = ray.unitOrthogonal().transpose();
    across.row(1) = ray.cross(Eigen::Vector3d(across.row(0).transpose())).transpose();
    const Eigen::Vector2d residual = across * direction;
    const Eigen::Matrix<double, 2, 3> by_point =
        across * (Eigen::Matrix3d::Identity() - direction * direction.transpose()) / distance;
    Eigen::Matrix<double, 2, 6> jacobian;
    jacobian.leftCols<3>() = -by_point * camera_from_world_rotation;
    jacobian.rightCols<3>() = by_point * cross_matrix(x_in_camera);
    normal.hessian += jacobian.transpose() * jacobian;
    normal.gradient += jacobian.transpose() * residual;
    normal.cost += residual.squaredNorm();
  }
  return normal;
}

Pose moved(const Pose& world_from_camera, const Vector6d& step) {
  return {(world_from_camera.rotation * rotation_from_vector(step.tail<3>())).normalized(),
          world_from_camera.translation + step.head<3>()};
}

/// Minimises the angles of the given data.
Pose minimise(std::span<const PointRay> data, std::span<const std::size_t> indices, const Pose& world_from_camera,
              int max_steps) {
  return levenberg_marquardt<6>(
      world_from_camera, [&](const Pose& pose) { return linearise(data, indices, pose); }, moved, max_steps);
}

class AbsolutePoseProblem {
 public:
  using Model = Pose;
  static constexpr std::size_t kSampleSize = 3;

  explicit AbsolutePoseProblem(std::span<const PointRay> data) : data_(data) {}

  std::size_t size() const { return data_.size(); }

  std::vector<Pose> solve(const std::array<std::size_t, kSampleSize>& sample) const {
    opengv::bearingVectors_t rays;
    opengv::points_t points;
    for (const std::size_t i : sample) {
      rays.push_back(data_[i].ray_in_camera);
      points.push_back(data_[i].point_in_world);
    }
    opengv::absolute_pose::CentralAbsoluteAdapter adapter(rays, points);
    std::vector<Pose> poses;
    for (const auto& world_from_camera : opengv::absolute_pose::p3p_kneip(adapter)) {
      if (!world_from_camera.allFinite()) continue;
      const Eigen::Matrix3d rotation = world_from_camera.leftCols<3>();
      poses.push_back({Eigen::Quaterniond(rotation).normalized(), world_from_camera.col(3)});
    }
    return poses;
  }

  /// Squared chord between the ray and the point's direction: the squared angle for small ones, and large behind the camera.
  auto evaluator(const Pose& world_from_camera) const {
    return [this, world_from_camera, rotation = Eigen::Matrix3d(world_from_camera.rotation.toRotationMatrix())](std::size_t i) {
      const Eigen::Vector3d towards = data_[i].point_in_world - world_from_camera.translation;
      return (towards.normalized() - rotation * data_[i].ray_in_camera).squaredNorm();
    };
  }

  Pose refine(const Pose& world_from_camera, const std::vector<std::size_t>& inliers) const {
    constexpr int kLocalSteps = 5;
    return minimise(data_, inliers, world_from_camera, kLocalSteps);
  }

 private:
  std::span<const PointRay> data_;
};

}  // namespace

std::optional<AbsolutePose> estimate_absolute_pose(std::span<const PointRay> data, const AbsolutePoseOptions& options) {
  const AbsolutePoseProblem problem(data);
  const auto best = ransac(problem, {options.max_error_rad, options.confidence, options.max_iterations, options.seed});
  constexpr std::size_t kMinInliers = 5;
  constexpr int kRounds = 3;
  constexpr int kSteps = 20;
  if (!best || best->inliers.size() < kMinInliers) return std::nullopt;
  AbsolutePose result;
  result.world_from_camera = best->model;
  result.inliers = best->inliers;
  result.iterations = best->iterations;
  for (int round = 0; round < kRounds; ++round) {
    result.world_from_camera = minimise(data, result.inliers, result.world_from_camera, kSteps);
    auto next = inliers_of(problem, result.world_from_camera, options.max_error_rad);
    if (next.size() < kMinInliers) return std::nullopt;
    const bool settled = next == result.inliers;
    result.inliers = std::move(next);
    if (settled) break;
  }
  const NormalEquations<6> normal = linearise(data, result.inliers, result.world_from_camera);
  const double num_residuals = 2.0 * static_cast<double>(result.inliers.size());
  result.information = normal.hessian / std::max(normal.cost / (num_residuals - 6.0), 1e-14);
  result.rms_error_rad = std::sqrt(normal.cost / num_residuals);
  return result;
}

}  // namespace fabloop
