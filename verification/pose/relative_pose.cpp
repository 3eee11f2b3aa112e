// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/relative_pose.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <utility>

#include "verification/median.h"
#include "verification/pose/epipolar_refinement.h"
#include "verification/pose/inlier_noise.h"
#include "verification/pose/ransac.h"
#include "verification/pose/relative_pose_problem.h"

namespace fabloop {
namespace {

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

std::vector<std::size_t> where_possible(const std::vector<double>& p_true) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < p_true.size(); ++i) {
    if (p_true[i] > 0) indices.push_back(i);
  }
  return indices;
}

/// A pose and which pairs are true about it.
struct Settled {
  Pose match_from_query;
  std::vector<double> residuals_rad;  ///< Of all pairs; pi for those behind a camera.
  InlierNoise noise;
  std::vector<std::size_t> inliers;
};

/// The inverse covariance of a refined pose: never more certain than the noise says, nor than the jackknife. A few accidental
/// inliers where the true ones say little bend the pose to themselves; the residuals hardly show it, but without each of them the
/// pose would be elsewhere. That covariance is H^-1 (sum w J J^T (r / (1 - h))^2) H^-1 with the leverages h = w J^T H^-1 J
/// (MacKinnon & White 1985, HC3); in the directions where it is larger by more than luck, it counts.
Matrix5d information_of(std::span<const RayPair> pairs, const Settled& settled) {
  const InlierNoise& noise = settled.noise;
  const double variance = noise.sigma_rad * noise.sigma_rad;
  const EpipolarEquations equations = equations_of(pairs, settled.inliers, noise.p_true);
  const Matrix5d hessian = linearise(equations, settled.match_from_query).hessian;
  const Eigen::LLT<Matrix5d> factor(hessian);
  if (factor.info() != Eigen::Success) return hessian / variance;
  constexpr double kMaxLeverage = 0.95;  // of a pair without which nothing would be known in some direction
  const auto rows = equations.jacobian(frame_of(settled.match_from_query));
  Matrix5d scatter = Matrix5d::Zero();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Eigen::Map<const Vector5d> row(rows[k].data());
    const double weight = noise.p_true[settled.inliers[k]];
    const double leverage = std::min(kMaxLeverage, weight * factor.matrixL().solve(row).squaredNorm());
    const double left_out = settled.residuals_rad[settled.inliers[k]] / (1 - leverage);
    scatter += (weight * left_out * left_out) * row * row.transpose();
  }
  // In coordinates in which the model's covariance is the identity.
  const Matrix5d whitened = factor.matrixL().solve(factor.matrixL().solve(scatter).transpose()) / variance;
  const Eigen::SelfAdjointEigenSolver<Matrix5d> eigen(0.5 * (whitened + whitened.transpose()));
  // A variance estimated from n residuals has a relative standard deviation of sqrt(2 / n).
  constexpr double kSigmas = 3.0;
  const double luck = 1.0 + kSigmas * std::sqrt(2.0 / noise.num_true);
  const Vector5d inflation = eigen.eigenvalues().unaryExpr([&](double ratio) { return ratio > luck ? ratio : 1.0; });
  const Matrix5d root = factor.matrixL().toDenseMatrix() * eigen.eigenvectors();
  return root * inflation.cwiseInverse().asDiagonal() * root.transpose() / variance;
}

Settled settled_at(const EpipolarEquations& equations, const Pose& match_from_query, double max_error_rad) {
  Settled at{match_from_query, equations.angles(frame_of(match_from_query), max_error_rad), {}, {}};
  at.noise = estimate_inlier_noise(at.residuals_rad, max_error_rad, 5);
  at.inliers = where_possible(at.noise.p_true);
  return at;
}

/// Refines by expectation maximisation: which pairs are true, and the pose that these tell, in turn.
std::optional<Settled> settle(std::span<const RayPair> pairs, const Pose& match_from_query, double max_error_rad) {
  constexpr int kRounds = 4;
  constexpr int kSteps = 20;
  constexpr std::size_t kMinInliers = 6;
  const EpipolarEquations equations = equations_of(pairs);
  Settled now = settled_at(equations, match_from_query, max_error_rad);
  for (int round = 0; round < kRounds && now.inliers.size() >= kMinInliers; ++round) {
    const Pose refined = minimise(equations_of(pairs, now.inliers, now.noise.p_true), now.match_from_query, kSteps);
    Settled next = settled_at(equations, refined, max_error_rad);
    const bool has_settled = round > 0 && next.inliers == now.inliers;
    now = std::move(next);
    if (has_settled) break;
  }
  if (now.inliers.size() < kMinInliers) return std::nullopt;
  return now;
}

RelativePose relative_pose_of(std::span<const RayPair> pairs, Settled settled, int iterations) {
  RelativePose result;
  result.match_from_query = settled.match_from_query;
  result.direction_basis = direction_axes(settled.match_from_query.translation);
  result.information = information_of(pairs, settled);
  result.noise_rad = settled.noise.sigma_rad;
  result.num_true = settled.noise.num_true;
  result.inliers = std::move(settled.inliers);
  result.iterations = iterations;
  return result;
}

/// Whether the pairs speak for the one rather than the other, among as many accidental ones as either leaves.
bool is_likelier(const Settled& one, const Settled& other, double max_error_rad) {
  const double one_pair = 1.0 / max_error_rad;
  const double floor = std::max(one_pair, 0.5 * (one.noise.floor + other.noise.floor));
  return log_likelihood_over_floor(one.residuals_rad, one.noise, floor) >
         log_likelihood_over_floor(other.residuals_rad, other.noise, floor);
}

/// The pose or one that most of its inliers lie closer to. Where views overlap little, poses many degrees apart have the same
/// pairs within the threshold, and the sum of truncated squares hardly tells which is right; the noise does.
Settled sharper_of(std::span<const RayPair> pairs, Settled found, const RelativePoseOptions& options) {
  constexpr double kSharper = 0.25;
  constexpr double kConfidence = 0.95;  // there is a pose already, and few of its inliers agree so closely
  constexpr int kMaxIterations = 200;
  constexpr double kSharpEnough = 0.1;
  if (found.noise.sigma_rad < kSharpEnough * options.max_error_rad) return found;
  std::vector<RayPair> inliers;
  for (const std::size_t i : found.inliers) inliers.push_back(pairs[i]);
  RelativePoseOptions sharper = options;
  sharper.max_error_rad *= kSharper;
  const RelativePoseProblem problem(inliers, sharper);
  const auto best = ransac(problem, {sharper.max_error_rad, kConfidence, kMaxIterations, options.seed, 0});
  if (!best) return found;
  auto rival = settle(pairs, best->model, options.max_error_rad);
  return rival && is_likelier(*rival, found, options.max_error_rad) ? std::move(*rival) : found;
}

}  // namespace

std::optional<RelativePose> estimate_relative_pose(std::span<const RayPair> pairs, const RelativePoseOptions& options) {
  const RelativePoseProblem problem(pairs, options);
  const auto best =
      ransac(problem, {options.max_error_rad, options.confidence, options.max_iterations, options.seed, options.min_inliers});
  if (!best) return std::nullopt;
  auto settled = settle(pairs, best->model, options.max_error_rad);
  if (!settled) return std::nullopt;
  return relative_pose_of(pairs, sharper_of(pairs, std::move(*settled), options), best->iterations);
}

double log_likelihood(const RelativePose& relative, double max_error_rad) {
  constexpr double kMaxSharpness = 20.0;  // a noise below a twentieth of the threshold is luck
  return relative.num_true * std::log(std::min(kMaxSharpness, max_error_rad / relative.noise_rad));
}

std::optional<RelativePose> refine_relative_pose(std::span<const RayPair> pairs, const Pose& match_from_query,
                                                 const RelativePoseOptions& options) {
  if (match_from_query.translation.norm() < 1e-12) return std::nullopt;
  auto settled = settle(pairs, {match_from_query.rotation, match_from_query.translation.normalized()}, options.max_error_rad);
  if (!settled) return std::nullopt;
  return relative_pose_of(pairs, std::move(*settled), 0);
}

RotationFit fit_rotation(std::span<const RayPair> pairs, std::span<const std::size_t> indices, double max_error_rad) {
  RotationFit fit;
  if (indices.empty()) return fit;
  constexpr int kRounds = 5;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
    for (const std::size_t i : indices) {
      // Cauchy's weight, from the second round on.
      const double error = round == 0 ? 0 : angle_between(fit.match_from_query * pairs[i].query, pairs[i].match) / max_error_rad;
      correlation += pairs[i].match * pairs[i].query.transpose() / (1.0 + error * error);
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
    fit.match_from_query =
        Eigen::Quaterniond(Eigen::Matrix3d(svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose())).normalized();
  }
  std::size_t num_within = 0;
  for (const std::size_t i : indices)
    num_within += angle_between(fit.match_from_query * pairs[i].query, pairs[i].match) < max_error_rad;
  fit.share = static_cast<double>(num_within) / static_cast<double>(indices.size());
  return fit;
}

double median_parallax(std::span<const RayPair> pairs, std::span<const std::size_t> indices, const Pose& match_from_query) {
  std::vector<double> angles;
  angles.reserve(indices.size());
  for (const std::size_t i : indices) {
    const Eigen::Vector3d query_ray = match_from_query.rotation * pairs[i].query;
    angles.push_back(angle_between(query_ray, pairs[i].match));
  }
  return median(std::move(angles));
}

}  // namespace fabloop
