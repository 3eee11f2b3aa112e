// SPDX-License-Identifier: BSD-3-Clause
#include "verification/relative_pose.h"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <opengv/relative_pose/CentralRelativeAdapter.hpp>
#include <opengv/relative_pose/methods.hpp>

#include "verification/levenberg_marquardt.h"
#include "verification/ransac.h"

namespace fabloop {
namespace {

using Vector5d = Eigen::Matrix<double, 5, 1>;

/// E with match^T E query = 0.
Eigen::Matrix3d essential_matrix(const Pose& match_from_query) {
  return cross_matrix(match_from_query.translation) * match_from_query.rotation.toRotationMatrix();
}

/// Two unit vectors that span the plane across `direction`.
Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& direction) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = direction.unitOrthogonal();
  basis.col(1) = direction.cross(basis.col(0)).normalized();
  return basis;
}

/// Depths along both rays of their closest points; false when the rays meet behind a camera.
bool in_front_of_both(const RayPair& pair, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  const Eigen::Vector3d query_ray = rotation * pair.query;
  const double cosine = query_ray.dot(pair.match);
  const double a = pair.match.dot(translation);
  const double b = query_ray.dot(translation);
  // depth_match * match = translation + depth_query * query_ray, solved by least squares; the common positive factor is left out.
  return a - cosine * b > 0 && cosine * a - b > 0;
}

/// Sampson distance of rays on the unit sphere: e / |tangential gradient of e|, in radians.
struct EpipolarResidual {
  double error = 0;
  double gradient_norm = 0;
};

EpipolarResidual epipolar_residual(const RayPair& pair, const Eigen::Matrix3d& essential) {
  const Eigen::Vector3d from_query = essential * pair.query;
  const Eigen::Vector3d from_match = essential.transpose() * pair.match;
  const double error = pair.match.dot(from_query);
  const double squared = from_query.squaredNorm() + from_match.squaredNorm() - 2.0 * error * error;
  return {error, std::sqrt(std::max(squared, 1e-24))};
}

/// Epipolar residuals with respect to (rotation in the query frame, direction's tangent plane), radians.
NormalEquations<5> linearise(std::span<const RayPair> pairs, std::span<const std::size_t> indices, const Pose& match_from_query) {
  const Eigen::Matrix<double, 3, 2> basis = tangent_basis(match_from_query.translation);
  const Eigen::Matrix3d essential = essential_matrix(match_from_query);
  const Eigen::Matrix3d rotation = match_from_query.rotation.toRotationMatrix();
  NormalEquations<5> normal;
  for (const std::size_t i : indices) {
    const RayPair& pair = pairs[i];
    const EpipolarResidual residual = epipolar_residual(pair, essential);
    const double weight = 1.0 / residual.gradient_norm;
    Vector5d jacobian;
    jacobian.head<3>() = weight * pair.query.cross(essential.transpose() * pair.match);
    jacobian.tail<2>() = weight * (basis.transpose() * (rotation * pair.query).cross(pair.match));
    const double value = weight * residual.error;
    normal.hessian += jacobian * jacobian.transpose();
    normal.gradient += value * jacobian;
    normal.cost += value * value;
  }
  return normal;
}

Pose moved(const Pose& match_from_query, const Vector5d& step) {
  const Eigen::Matrix<double, 3, 2> basis = tangent_basis(match_from_query.translation);
  return {(match_from_query.rotation * rotation_from_vector(step.head<3>())).normalized(),
          (match_from_query.translation + basis * step.tail<2>()).normalized()};
}

/// Minimises the Sampson distances of the given pairs.
Pose minimise(std::span<const RayPair> pairs, std::span<const std::size_t> indices, const Pose& match_from_query, int max_steps) {
  return levenberg_marquardt<5>(
      match_from_query, [&](const Pose& pose) { return linearise(pairs, indices, pose); }, moved, max_steps);
}

/// The poses of an essential matrix that see every pair of the sample in front of both cameras.
void append_poses(const Eigen::Matrix3d& essential, std::span<const RayPair> pairs, const std::array<std::size_t, 5>& sample,
                  std::vector<Pose>& poses) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(essential, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  Eigen::Matrix3d v = svd.matrixV();
  if (u.determinant() < 0) u = -u;
  if (v.determinant() < 0) v = -v;
  const Eigen::Matrix3d w = (Eigen::Matrix3d() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished();
  for (const Eigen::Matrix3d& rotation :
       {Eigen::Matrix3d(u * w * v.transpose()), Eigen::Matrix3d(u * w.transpose() * v.transpose())}) {
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector3d translation = sign * u.col(2);
      const bool in_front = std::all_of(sample.begin(), sample.end(),
                                        [&](std::size_t i) { return in_front_of_both(pairs[i], rotation, translation); });
      if (in_front) poses.push_back({Eigen::Quaterniond(rotation).normalized(), translation});
    }
  }
}

class RelativePoseProblem {
 public:
  using Model = Pose;
  static constexpr std::size_t kSampleSize = 5;

  explicit RelativePoseProblem(std::span<const RayPair> pairs) : pairs_(pairs) {}

  std::size_t size() const { return pairs_.size(); }

  std::vector<Pose> solve(const std::array<std::size_t, kSampleSize>& sample) const {
    opengv::bearingVectors_t match_rays, query_rays;
    for (const std::size_t i : sample) {
      match_rays.push_back(pairs_[i].match);
      query_rays.push_back(pairs_[i].query);
    }
    opengv::relative_pose::CentralRelativeAdapter adapter(match_rays, query_rays);
    std::vector<Pose> poses;
    // OpenGV's essential matrices satisfy match^T E query = 0.
    for (const auto& essential : opengv::relative_pose::fivept_nister(adapter)) {
      if (essential.allFinite()) append_poses(essential, pairs_, sample, poses);
    }
    return poses;
  }

  auto evaluator(const Pose& match_from_query) const {
    return [this, essential = essential_matrix(match_from_query)](std::size_t i) {
      const EpipolarResidual residual = epipolar_residual(pairs_[i], essential);
      const double distance = residual.error / residual.gradient_norm;
      return distance * distance;
    };
  }

  Pose refine(const Pose& match_from_query, const std::vector<std::size_t>& inliers) const {
    constexpr int kLocalSteps = 5;
    return minimise(pairs_, inliers, match_from_query, kLocalSteps);
  }

 private:
  std::span<const RayPair> pairs_;
};

/// Inliers in front of both cameras.
std::vector<std::size_t> seen_inliers(const RelativePoseProblem& problem, std::span<const RayPair> pairs,
                                      const Pose& match_from_query, double max_error_rad) {
  std::vector<std::size_t> inliers = inliers_of(problem, match_from_query, max_error_rad);
  const Eigen::Matrix3d rotation = match_from_query.rotation.toRotationMatrix();
  std::erase_if(inliers, [&](std::size_t i) { return !in_front_of_both(pairs[i], rotation, match_from_query.translation); });
  return inliers;
}

std::optional<RelativePose> finish(std::span<const RayPair> pairs, Pose match_from_query, const RelativePoseOptions& options,
                                   int iterations) {
  const RelativePoseProblem problem(pairs);
  constexpr int kRounds = 3;
  constexpr int kSteps = 20;
  constexpr std::size_t kMinInliers = 6;
  std::vector<std::size_t> inliers = seen_inliers(problem, pairs, match_from_query, options.max_error_rad);
  for (int round = 0; round < kRounds && inliers.size() >= kMinInliers; ++round) {
    match_from_query = minimise(pairs, inliers, match_from_query, kSteps);
    auto next = seen_inliers(problem, pairs, match_from_query, options.max_error_rad);
    const bool settled = next == inliers;
    inliers = std::move(next);
    if (settled) break;
  }
  if (inliers.size() < kMinInliers) return std::nullopt;
  RelativePose result;
  result.match_from_query = match_from_query;
  result.direction_basis = tangent_basis(match_from_query.translation);
  const NormalEquations<5> normal = linearise(pairs, inliers, match_from_query);
  const double variance = normal.cost / static_cast<double>(inliers.size() - 5);
  result.information = normal.hessian / std::max(variance, 1e-14);
  result.rms_error_rad = std::sqrt(normal.cost / static_cast<double>(inliers.size()));
  result.inliers = std::move(inliers);
  result.iterations = iterations;
  return result;
}

}  // namespace

std::optional<RelativePose> estimate_relative_pose(std::span<const RayPair> pairs, const RelativePoseOptions& options) {
  const RelativePoseProblem problem(pairs);
  const auto best = ransac(problem, {options.max_error_rad, options.confidence, options.max_iterations, options.seed});
  if (!best) return std::nullopt;
  return finish(pairs, best->model, options, best->iterations);
}

std::optional<RelativePose> refine_relative_pose(std::span<const RayPair> pairs, const Pose& match_from_query,
                                                 const RelativePoseOptions& options) {
  if (match_from_query.translation.norm() < 1e-12) return std::nullopt;
  return finish(pairs, {match_from_query.rotation, match_from_query.translation.normalized()}, options, 0);
}

double median_parallax(std::span<const RayPair> pairs, std::span<const std::size_t> indices, const Pose& match_from_query) {
  if (indices.empty()) return 0;
  std::vector<double> angles;
  angles.reserve(indices.size());
  for (const std::size_t i : indices) {
    const Eigen::Vector3d query_ray = match_from_query.rotation * pairs[i].query;
    angles.push_back(angle_between(query_ray, pairs[i].match));
  }
  const auto middle = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2);
  std::nth_element(angles.begin(), middle, angles.end());
  return *middle;
}

}  // namespace fabloop
