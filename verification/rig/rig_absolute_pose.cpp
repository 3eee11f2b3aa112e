// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <opengv/absolute_pose/AbsoluteAdapterBase.hpp>
#include <opengv/absolute_pose/methods.hpp>
#include <string>

#include "frontend/error.h"
#include "verification/pose/levenberg_marquardt.h"
#include "verification/pose/point_ray_residual.h"
#include "verification/pose/pose_step.h"
#include "verification/pose/ransac.h"
#include "verification/pose/truncated_noise.h"
#include "verification/rig/rig_pose.h"

namespace fabloop {
namespace {

/// OpenGV's view of the data: every ray is a camera of its own in the body's axes.
class RigPointRayAdapter final : public opengv::absolute_pose::AbsoluteAdapterBase {
 public:
  explicit RigPointRayAdapter(std::span<const RigPointRay> data) : data_(data) {}
  opengv::bearingVector_t getBearingVector(std::size_t i) const override { return data_[i].ray.ray_in_body; }
  double getWeight(std::size_t) const override { return 1.0; }
  opengv::translation_t getCamOffset(std::size_t i) const override { return data_[i].ray.origin_in_body; }
  opengv::rotation_t getCamRotation(std::size_t) const override { return opengv::rotation_t::Identity(); }
  opengv::point_t getPoint(std::size_t i) const override { return data_[i].point_in_world; }
  std::size_t getNumberCorrespondences() const override { return data_.size(); }

 private:
  std::span<const RigPointRay> data_;
};

NormalEquations<6> linearise(std::span<const RigPointRay> data, std::span<const std::size_t> indices,
                             const Pose& world_from_body) {
  const Eigen::Matrix3d rotation = world_from_body.rotation.toRotationMatrix();
  PointRaySum sum;
  for (const std::size_t i : indices) {
    const Eigen::Vector3d x_in_body = rotation.transpose() * (data[i].point_in_world - world_from_body.translation);
    sum.add(x_in_body, data[i].ray.origin_in_body, data[i].ray.ray_in_body);
  }
  return sum.in_world(rotation);
}

/// By a step of (translation in the world, rotation in the body).
Pose minimise(std::span<const RigPointRay> data, std::span<const std::size_t> indices, const Pose& world_from_body,
              int max_steps) {
  return levenberg_marquardt<6>(
      world_from_body, [&](const Pose& pose) { return linearise(data, indices, pose); }, moved_in_world, max_steps);
}

/// A pose as the loop scores it.
struct BodyPlacement {
  Eigen::Matrix3d body_from_world_rotation;
  Eigen::Vector3d body_in_world;

  Pose pose() const { return {Eigen::Quaterniond(body_from_world_rotation.transpose()).normalized(), body_in_world}; }
  static BodyPlacement from(const Pose& world_from_body) {
    return {world_from_body.rotation.conjugate().toRotationMatrix(), world_from_body.translation};
  }
};

class RigAbsoluteProblem {
 public:
  using Model = BodyPlacement;
  static constexpr std::size_t kSampleSize = 3;

  RigAbsoluteProblem(std::span<const RigPointRay> data, double max_error_rad)
      : data_(data), max_squared_error_(max_error_rad * max_error_rad), adapter_(data) {}

  std::size_t size() const { return data_.size(); }

  auto evaluator(const BodyPlacement& placement) const {
    return [data = data_, placement](std::size_t i) {
      const Eigen::Vector3d x_in_body = placement.body_from_world_rotation * (data[i].point_in_world - placement.body_in_world);
      return squared_sine(x_in_body - data[i].ray.origin_in_body, data[i].ray.ray_in_body);
    };
  }

  /// Roots that do not see their own sample are complex ones' real parts.
  std::vector<BodyPlacement> solve(const std::array<std::size_t, kSampleSize>& sample) const {
    std::vector<BodyPlacement> placements;
    const Eigen::Vector3d& origin = data_[sample[0]].ray.origin_in_body;
    const bool is_central =
        std::all_of(sample.begin(), sample.end(), [&](std::size_t i) { return data_[i].ray.origin_in_body == origin; });
    const opengv::transformations_t world_from_solved =
        is_central ? opengv::absolute_pose::p3p_kneip(adapter_, sample[0], sample[1], sample[2])
                   : opengv::absolute_pose::gp3p(adapter_, sample[0], sample[1], sample[2]);
    for (const opengv::transformation_t& solution : world_from_solved) {
      const Eigen::Matrix3d rotation = solution.leftCols<3>();
      // The central solver finds the camera, the generalised one the body.
      const Eigen::Vector3d body_in_world =
          solution.col(3) - (is_central ? Eigen::Vector3d(rotation * origin) : Eigen::Vector3d::Zero());
      const BodyPlacement placement{rotation.transpose(), body_in_world};
      const auto squared_error = evaluator(placement);
      const bool sees_sample =
          std::all_of(sample.begin(), sample.end(), [&](std::size_t i) { return squared_error(i) < max_squared_error_; });
      if (sees_sample) placements.push_back(placement);
    }
    return placements;
  }

  BodyPlacement refine(const BodyPlacement& placement, const std::vector<std::size_t>& inliers) const {
    constexpr int kLocalSteps = 3;
    return BodyPlacement::from(minimise(data_, inliers, placement.pose(), kLocalSteps));
  }

 private:
  std::span<const RigPointRay> data_;
  double max_squared_error_;
  RigPointRayAdapter adapter_;
};

std::optional<RigAbsolutePose> finish(const RigAbsoluteProblem& problem, std::span<const RigPointRay> data,
                                      const RansacResult<BodyPlacement>& best, const RigAbsolutePoseOptions& options) {
  constexpr std::size_t kMinInliers = 5;
  constexpr int kRounds = 4;
  constexpr int kSteps = 20;
  RigAbsolutePose result;
  result.world_from_body = best.model.pose();
  result.inliers = best.inliers;
  result.iterations = best.iterations;
  for (int round = 0; round < kRounds && result.inliers.size() >= kMinInliers; ++round) {
    result.world_from_body = minimise(data, result.inliers, result.world_from_body, kSteps);
    auto next = inliers_of(problem, BodyPlacement::from(result.world_from_body), options.max_error_rad);
    const bool settled = next == result.inliers;
    result.inliers = std::move(next);
    if (settled) break;
  }
  if (result.inliers.size() < kMinInliers) return std::nullopt;
  const NormalEquations<6> normal = linearise(data, result.inliers, result.world_from_body);
  const double num_residuals = 2.0 * static_cast<double>(result.inliers.size());
  constexpr double kMinVariance = 1e-14;
  result.information =
      noise_from_inliers<2>(normal.cost / (num_residuals - 6.0), options.max_error_rad, kMinVariance).information_scale() *
      normal.hessian;
  result.rms_error_rad = std::sqrt(normal.cost / num_residuals);
  return result;
}

void validate(std::span<const RigPointRay> data, const RigAbsolutePoseOptions& options) {
  if (!(options.max_error_rad > 0)) throw InputError("rig absolute pose: max_error_rad must be positive");
  for (std::size_t i = 0; i < data.size(); ++i) {
    const bool finite =
        data[i].point_in_world.allFinite() && data[i].ray.origin_in_body.allFinite() && data[i].ray.ray_in_body.allFinite();
    if (!finite) throw InputError("rig absolute pose: datum " + std::to_string(i) + " is not finite; leave it out");
  }
}

}  // namespace

std::optional<RigAbsolutePose> estimate_rig_absolute_pose(std::span<const RigPointRay> data,
                                                          const RigAbsolutePoseOptions& options) {
  validate(data, options);
  const RigAbsoluteProblem problem(data, options.max_error_rad);
  const auto best = ransac(problem, {options.max_error_rad, options.confidence, options.max_iterations, options.seed});
  if (!best) return std::nullopt;
  return finish(problem, data, *best, options);
}

}  // namespace fabloop
