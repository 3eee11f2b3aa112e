// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/joint_pose.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "verification/median.h"
#include "verification/pose/levenberg_marquardt.h"
#include "verification/pose/pose_step.h"
#include "verification/pose/residuals.h"

namespace fabloop {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Below this distance, as a share of the depth, the rays' epipolar planes are undefined and only the points count.
constexpr double kMinBaseline = 0.01;
/// A pixel's noise over a focal length is never smaller than this.
constexpr double kMinJointSigmaRad = 1e-6;

/// A residual vector with its derivative by (translation, rotation) in the query's axes.
template <int kRows>
struct Residual {
  Eigen::Matrix<double, kRows, 1> value;
  Eigen::Matrix<double, kRows, 6> jacobian;
};

Residual<1> ray_residual(const RayPair& pair, const Pose& match_from_query, const Eigen::Matrix3d& essential,
                         const Eigen::Matrix3d& rotation) {
  const EpipolarResidual epipolar = epipolar_residual(pair.query, pair.match, essential);
  const EpipolarJacobian derivative =
      epipolar_jacobian(epipolar, pair.query, pair.match, essential, rotation, match_from_query.translation);
  Residual<1> residual;
  residual.value << epipolar.angle();
  residual.jacobian << derivative.by_translation.transpose() * rotation, derivative.by_rotation.transpose();
  return residual;
}

/// The part of a point's direction across its ray, with the derivative of the point in the ray's camera given.
Residual<2> point_residual(const Eigen::Vector3d& x_in_camera, const Eigen::Vector3d& ray,
                           const Eigen::Matrix<double, 3, 6>& point_jacobian) {
  const DirectionResidual direction = direction_residual(x_in_camera, ray);
  return {direction.value, direction.by_point * point_jacobian};
}

Residual<2> match_point_residual(const PointRay& datum, const Pose& match_from_query, const Eigen::Matrix3d& rotation) {
  const Eigen::Vector3d x_in_query = rotation.transpose() * (datum.point_in_world - match_from_query.translation);
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << -Eigen::Matrix3d::Identity(), cross_matrix(x_in_query);
  return point_residual(x_in_query, datum.ray_in_camera, jacobian);
}

Residual<2> query_point_residual(const PointRay& datum, const Pose& match_from_query, const Eigen::Matrix3d& rotation) {
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << rotation, -rotation * cross_matrix(datum.point_in_world);
  return point_residual(match_from_query * datum.point_in_world, datum.ray_in_camera, jacobian);
}

/// Which data count, and how much.
struct Active {
  std::vector<std::size_t> pairs, match_points, query_points;
  double ray_sigma_rad = kMinJointSigmaRad, point_sigma_rad = kMinJointSigmaRad;
};

struct Scatter {
  double sum = 0;
  double count = 0;
  double sigma() const { return std::max(kMinJointSigmaRad, std::sqrt(sum / std::max(1.0, count))); }
};

template <typename Data, typename ResidualOf>
std::vector<std::size_t> select(const Data& data, double max_error_rad, const ResidualOf& residual_of, Scatter& scatter) {
  std::vector<std::size_t> inliers;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const auto residual = residual_of(data[i]);
    if (residual.value.squaredNorm() > max_error_rad * max_error_rad) continue;
    inliers.push_back(i);
    scatter.sum += residual.value.squaredNorm();
    scatter.count += static_cast<double>(residual.value.size());
  }
  return inliers;
}

Active select_inliers(const JointData& data, const Pose& pose, const JointPoseOptions& options) {
  const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
  const Eigen::Matrix3d essential = essential_matrix(pose);
  Active active;
  Scatter ray_scatter, point_scatter;
  active.pairs = select(
      data.pairs, options.max_ray_error_rad, [&](const RayPair& pair) { return ray_residual(pair, pose, essential, rotation); },
      ray_scatter);
  active.match_points = select(
      data.match_points, options.max_point_error_rad,
      [&](const PointRay& datum) { return match_point_residual(datum, pose, rotation); }, point_scatter);
  active.query_points = select(
      data.query_points, options.max_point_error_rad,
      [&](const PointRay& datum) { return query_point_residual(datum, pose, rotation); }, point_scatter);
  active.ray_sigma_rad = ray_scatter.sigma();
  active.point_sigma_rad = point_scatter.sigma();
  return active;
}

double median_depth(const JointData& data, const Active& active, const Pose& match_from_query) {
  std::vector<double> depths;
  for (const std::size_t i : active.match_points)
    depths.push_back((data.match_points[i].point_in_world - match_from_query.translation).norm());
  for (const std::size_t i : active.query_points) depths.push_back(data.query_points[i].point_in_world.norm());
  return median(std::move(depths));
}

NormalEquations<6> linearise(const JointData& data, const Active& active, const Pose& pose, double min_baseline) {
  const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
  const Eigen::Matrix3d essential = essential_matrix(pose);
  NormalEquations<6> normal;
  const auto add = [&normal](const auto& residual, double sigma_rad) {
    const double weight = 1.0 / (sigma_rad * sigma_rad);
    normal.hessian += weight * residual.jacobian.transpose() * residual.jacobian;
    normal.gradient += weight * residual.jacobian.transpose() * residual.value;
    normal.cost += weight * residual.value.squaredNorm();
  };
  if (pose.translation.norm() > min_baseline) {
    for (const std::size_t i : active.pairs) add(ray_residual(data.pairs[i], pose, essential, rotation), active.ray_sigma_rad);
  }
  for (const std::size_t i : active.match_points)
    add(match_point_residual(data.match_points[i], pose, rotation), active.point_sigma_rad);
  for (const std::size_t i : active.query_points)
    add(query_point_residual(data.query_points[i], pose, rotation), active.point_sigma_rad);
  return normal;
}

}  // namespace

JointPose refine_joint_pose(const JointData& data, const Pose& match_from_query, const JointPoseOptions& options) {
  constexpr int kRounds = 3;
  constexpr int kSteps = 20;
  JointPose result;
  result.match_from_query = match_from_query;
  Active active = select_inliers(data, match_from_query, options);
  double min_baseline = kMinBaseline * median_depth(data, active, match_from_query);
  for (int round = 0; round < kRounds; ++round) {
    result.match_from_query = levenberg_marquardt<6>(
        result.match_from_query, [&](const Pose& pose) { return linearise(data, active, pose, min_baseline); },
        moved_in_own_frame, kSteps);
    active = select_inliers(data, result.match_from_query, options);
  }
  const Matrix6d hessian = linearise(data, active, result.match_from_query, min_baseline).hessian;
  constexpr double kRelativeRidge = 1e-12;
  result.covariance = (hessian + kRelativeRidge * hessian.trace() * Matrix6d::Identity()).inverse();
  result.median_depth = median_depth(data, active, result.match_from_query);
  result.num_point_inliers = active.match_points.size() + active.query_points.size();
  result.pair_inliers = std::move(active.pairs);
  return result;
}

}  // namespace fabloop
