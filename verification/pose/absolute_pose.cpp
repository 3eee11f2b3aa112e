// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/absolute_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opengv/absolute_pose/AbsoluteAdapterBase.hpp>
#include <opengv/absolute_pose/methods.hpp>

#include "frontend/error.h"
#include "verification/pose/levenberg_marquardt.h"
#include "verification/pose/point_ray_residual.h"
#include "verification/pose/pose_step.h"
#include "verification/pose/ransac.h"
#include "verification/pose/truncated_noise.h"

namespace fabloop {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

NormalEquations<6> linearise(std::span<const PointRay> data, std::span<const std::size_t> indices,
                             const Pose& world_from_camera) {
  const Eigen::Matrix3d rotation = world_from_camera.rotation.toRotationMatrix();
  PointRaySum sum;
  for (const std::size_t i : indices) {
    const Eigen::Vector3d x_in_camera = rotation.transpose() * (data[i].point_in_world - world_from_camera.translation);
    sum.add(x_in_camera, Eigen::Vector3d::Zero(), data[i].ray_in_camera);
  }
  return sum.in_world(rotation);
}

/// Minimises the angles of the given data.
Pose minimise(std::span<const PointRay> data, std::span<const std::size_t> indices, const Pose& world_from_camera,
              int max_steps) {
  return levenberg_marquardt<6>(
      world_from_camera, [&](const Pose& pose) { return linearise(data, indices, pose); }, moved_in_world, max_steps);
}

/// OpenGV's view of the data.
class PointRayAdapter final : public opengv::absolute_pose::AbsoluteAdapterBase {
 public:
  explicit PointRayAdapter(std::span<const PointRay> data) : data_(data) {}
  opengv::bearingVector_t getBearingVector(std::size_t i) const override { return data_[i].ray_in_camera; }
  double getWeight(std::size_t) const override { return 1.0; }
  opengv::translation_t getCamOffset(std::size_t) const override { return opengv::translation_t::Zero(); }
  opengv::rotation_t getCamRotation(std::size_t) const override { return opengv::rotation_t::Identity(); }
  opengv::point_t getPoint(std::size_t i) const override { return data_[i].point_in_world; }
  std::size_t getNumberCorrespondences() const override { return data_.size(); }

 private:
  std::span<const PointRay> data_;
};

/// A pose as the loop scores it.
struct CameraPlacement {
  Eigen::Matrix3d world_from_camera_rotation;
  Eigen::Vector3d centre_in_world;

  Pose pose() const { return {Eigen::Quaterniond(world_from_camera_rotation).normalized(), centre_in_world}; }
};

/// The solver's roots: at most four, so the loop takes nothing from the heap.
class Placements {
 public:
  void push_back(const CameraPlacement& placement) { placements_[count_++] = placement; }
  const CameraPlacement* begin() const { return placements_.data(); }
  const CameraPlacement* end() const { return placements_.data() + count_; }

 private:
  std::array<CameraPlacement, 4> placements_;
  std::size_t count_ = 0;
};

class AbsolutePoseProblem {
 public:
  using Model = CameraPlacement;
  static constexpr std::size_t kSampleSize = 3;

  AbsolutePoseProblem(std::span<const PointRay> data, double max_error_rad)
      : data_(data), max_squared_error_(max_error_rad * max_error_rad), adapter_(data) {}

  std::size_t size() const { return data_.size(); }

  auto evaluator(const CameraPlacement& placement) const {
    return [data = data_, placement](std::size_t i) {
      return squared_sine(data[i].point_in_world - placement.centre_in_world,
                          placement.world_from_camera_rotation * data[i].ray_in_camera);
    };
  }

  /// OpenGV returns the real parts of all four roots; those of complex ones do not see their own sample.
  Placements solve(const std::array<std::size_t, kSampleSize>& sample) const {
    Placements placements;
    for (const auto& world_from_camera : opengv::absolute_pose::p3p_kneip(adapter_, sample[0], sample[1], sample[2])) {
      const CameraPlacement placement{world_from_camera.leftCols<3>(), world_from_camera.col(3)};
      const auto squared_error = evaluator(placement);
      const bool sees_sample =
          std::all_of(sample.begin(), sample.end(), [&](std::size_t i) { return squared_error(i) < max_squared_error_; });
      if (sees_sample) placements.push_back(placement);
    }
    return placements;
  }

  CameraPlacement refine(const CameraPlacement& placement, const std::vector<std::size_t>& inliers) const {
    constexpr int kLocalSteps = 3;
    const Pose pose = minimise(data_, inliers, placement.pose(), kLocalSteps);
    return {pose.rotation.toRotationMatrix(), pose.translation};
  }

 private:
  std::span<const PointRay> data_;
  double max_squared_error_;
  PointRayAdapter adapter_;
};

/// From the inliers' variance, or as known.
TruncatedNoise ray_noise(double variance_of_inliers, const AbsolutePoseOptions& options) {
  constexpr double kMinVariance = 1e-14;
  if (!options.noise_rad) return noise_from_inliers<2>(variance_of_inliers, options.max_error_rad, kMinVariance);
  const double variance = *options.noise_rad * *options.noise_rad;
  return {variance, kept_variance_share<2>(variance, options.max_error_rad)};
}

/// The pose on its inliers, minimised until they stay the same; none when too few are left.
std::optional<AbsolutePose> finish(const AbsolutePoseProblem& problem, std::span<const PointRay> data,
                                   const RansacResult<CameraPlacement>& best, const AbsolutePoseOptions& options) {
  constexpr std::size_t kMinInliers = 5;
  constexpr int kRounds = 3;
  constexpr int kSteps = 20;
  if (best.inliers.size() < kMinInliers) return std::nullopt;
  AbsolutePose result;
  result.world_from_camera = best.model.pose();
  result.inliers = best.inliers;
  result.iterations = best.iterations;
  for (int round = 0; round < kRounds; ++round) {
    result.world_from_camera = minimise(data, result.inliers, result.world_from_camera, kSteps);
    const CameraPlacement placement{result.world_from_camera.rotation.toRotationMatrix(), result.world_from_camera.translation};
    auto next = inliers_of(problem, placement, options.max_error_rad);
    if (next.size() < kMinInliers) return std::nullopt;
    const bool settled = next == result.inliers;
    result.inliers = std::move(next);
    if (settled) break;
  }
  const NormalEquations<6> normal = linearise(data, result.inliers, result.world_from_camera);
  const double num_residuals = 2.0 * static_cast<double>(result.inliers.size());
  result.information = ray_noise(normal.cost / (num_residuals - 6.0), options).information_scale() * normal.hessian;
  result.rms_error_rad = std::sqrt(normal.cost / num_residuals);
  return result;
}

}  // namespace

std::optional<AbsolutePose> estimate_absolute_pose(std::span<const PointRay> data, const AbsolutePoseOptions& options) {
  if (!(options.max_error_rad > 0)) throw InputError("absolute pose: max_error_rad must be positive");
  const AbsolutePoseProblem problem(data, options.max_error_rad);
  const auto best = ransac(problem, {options.max_error_rad, options.confidence, options.max_iterations, options.seed});
  if (!best) return std::nullopt;
  return finish(problem, data, *best, options);
}

}  // namespace fabloop
