// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/alignment.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opengv/point_cloud/PointCloudAdapterBase.hpp>
#include <opengv/point_cloud/methods.hpp>
#include <string>

#include "frontend/error.h"
#include "verification/pose/levenberg_marquardt.h"
#include "verification/pose/ransac.h"
#include "verification/pose/truncated_noise.h"

namespace fabloop {
namespace {

struct Similarity {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  double scale = 1;

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return scale * (rotation * x) + translation; }
};

/// By a step of (translation, rotation in the query's axes, logarithm of the scale).
template <int kDimension>
Similarity moved_similarity(const Similarity& at, const Eigen::Matrix<double, kDimension, 1>& step) {
  Similarity next{at.rotation * rotation_from_vector(step.template segment<3>(3)).toRotationMatrix(),
                  at.translation + at.rotation * step.template head<3>(), at.scale};
  if constexpr (kDimension == 7) next.scale *= std::exp(step(6));
  return next;
}

Eigen::Matrix3d covariance(const Eigen::Vector3d& x, const PointNoise& noise) {
  const double distance = x.norm();
  const double across = noise.floor + noise.across * distance;
  const double along = noise.floor + noise.along * distance + noise.along_squared * distance * distance;
  Eigen::Matrix3d result = across * across * Eigen::Matrix3d::Identity();
  if (distance > 0) result += (along * along - across * across) / (distance * distance) * x * x.transpose();
  return result;
}

/// OpenGV's view of the pairs: frame 1 is the match, 2 the query.
class PointPairAdapter final : public opengv::point_cloud::PointCloudAdapterBase {
 public:
  explicit PointPairAdapter(std::span<const PointPair> pairs) : pairs_(pairs) {}
  opengv::point_t getPoint1(std::size_t i) const override { return pairs_[i].in_match; }
  opengv::point_t getPoint2(std::size_t i) const override { return pairs_[i].in_query; }
  std::size_t getNumberCorrespondences() const override { return pairs_.size(); }
  double getWeight(std::size_t) const override { return 1.0; }

 private:
  std::span<const PointPair> pairs_;
};

class AlignmentProblem {
 public:
  using Model = Similarity;
  static constexpr std::size_t kSampleSize = 3;

  AlignmentProblem(std::span<const PointPair> pairs, const AlignmentOptions& options)
      : pairs_(pairs), scale_(options.scale), adapter_(pairs) {
    query_covariances_.reserve(pairs.size());
    match_covariances_.reserve(pairs.size());
    for (const PointPair& pair : pairs) {
      query_covariances_.push_back(covariance(pair.in_query, options.query_noise));
      match_covariances_.push_back(covariance(pair.in_match, options.match_noise));
    }
  }

  std::size_t size() const { return pairs_.size(); }

  std::vector<Similarity> solve(const std::array<std::size_t, kSampleSize>& sample) const {
    Eigen::Matrix<double, 3, 4> match_from_query;
    double scale = 1;
    if (scale_ == AlignmentScale::Fixed) {
      const std::vector<int> indices{static_cast<int>(sample[0]), static_cast<int>(sample[1]), static_cast<int>(sample[2])};
      match_from_query = opengv::point_cloud::threept_arun(adapter_, indices);
    } else {
      Eigen::Matrix3d query, match;
      for (int i = 0; i < 3; ++i) {
        query.col(i) = pairs_[sample[static_cast<std::size_t>(i)]].in_query;
        match.col(i) = pairs_[sample[static_cast<std::size_t>(i)]].in_match;
      }
      match_from_query = Eigen::umeyama(query, match, true).topRows<3>();
      scale = match_from_query.col(0).norm();
    }
    if (!match_from_query.allFinite() || !(scale > 0)) return {};
    return {{match_from_query.leftCols<3>() / scale, match_from_query.col(3), scale}};
  }

  /// Squared Mahalanobis distance.
  auto evaluator(const Similarity& model) const {
    return [this, model](std::size_t i) {
      const Eigen::Vector3d residual = pairs_[i].in_match - model * pairs_[i].in_query;
      return residual.dot(weight(i, model) * residual);
    };
  }

  Similarity refine(const Similarity& model, const std::vector<std::size_t>& inliers) const {
    constexpr int kLocalSteps = 3;
    return minimise(model, inliers, kLocalSteps);
  }

  Similarity minimise(const Similarity& start, std::span<const std::size_t> indices, int max_steps) const {
    return scale_ == AlignmentScale::Free ? minimise_over<7>(start, indices, max_steps)
                                          : minimise_over<6>(start, indices, max_steps);
  }

  /// Normal equations of the Mahalanobis distances r^T W r, W^-1 = C_m + s^2 R C_q R^T. These are what is left of the distances
  /// of both measurements from the point that fits them best, q + s C_q R^T W r in the query; the derivative of r taken there
  /// gives the whole gradient, that of W included. It makes the alignment the same seen from either side.
  template <int kDimension>
  NormalEquations<kDimension> linearise(const Similarity& model, std::span<const std::size_t> indices) const {
    NormalEquations<kDimension> normal;
    const Eigen::Matrix3d turn = model.scale * model.rotation;
    for (const std::size_t i : indices) {
      const Eigen::Vector3d residual = pairs_[i].in_match - model * pairs_[i].in_query;
      const Eigen::Matrix3d information = weight(i, model);
      const Eigen::Vector3d best_in_query =
          pairs_[i].in_query + query_covariances_[i] * (turn.transpose() * (information * residual));
      Eigen::Matrix<double, 3, kDimension> jacobian;
      jacobian.template leftCols<3>() = -model.rotation;
      jacobian.template middleCols<3>(3) = turn * cross_matrix(best_in_query);
      if constexpr (kDimension == 7) jacobian.col(6) = -turn * best_in_query;
      const Eigen::Matrix<double, kDimension, 3> weighted = jacobian.transpose() * information;
      normal.hessian.noalias() += weighted * jacobian;
      normal.gradient.noalias() += weighted * residual;
      normal.cost += residual.dot(information * residual);
    }
    return normal;
  }

 private:
  /// Inverse covariance of a residual: the match's and the turned query's noise together.
  Eigen::Matrix3d weight(std::size_t i, const Similarity& model) const {
    const Eigen::Matrix3d turn = model.scale * model.rotation;
    return (match_covariances_[i] + turn * query_covariances_[i] * turn.transpose()).inverse();
  }

  template <int kDimension>
  Similarity minimise_over(const Similarity& start, std::span<const std::size_t> indices, int max_steps) const {
    return levenberg_marquardt<kDimension>(
        start, [&](const Similarity& at) { return linearise<kDimension>(at, indices); }, moved_similarity<kDimension>, max_steps);
  }

  std::span<const PointPair> pairs_;
  AlignmentScale scale_;
  PointPairAdapter adapter_;
  std::vector<Eigen::Matrix3d> query_covariances_, match_covariances_;
};

/// Inverse covariance at the optimum from the inliers' scatter over what the noise model expects.
template <int kDimension>
void state_information(const AlignmentProblem& problem, const Similarity& model, const AlignmentOptions& options,
                       PointAlignment& result) {
  const NormalEquations<kDimension> normal = problem.linearise<kDimension>(model, result.inliers);
  const double num_residuals = 3.0 * static_cast<double>(result.inliers.size());
  constexpr double kMinVariance = 1e-12;
  const TruncatedNoise noise =
      noise_from_inliers<3>(normal.cost / (num_residuals - kDimension), options.max_error_sigmas, kMinVariance);
  result.information.topLeftCorner<kDimension, kDimension>() = noise.information_scale() * normal.hessian;
  result.rms_error_sigmas = std::sqrt(normal.cost / num_residuals);
}

std::optional<PointAlignment> finish(const AlignmentProblem& problem, const RansacResult<Similarity>& best,
                                     const AlignmentOptions& options) {
  constexpr std::size_t kMinInliers = 5;
  constexpr int kRounds = 4;
  constexpr int kSteps = 20;
  Similarity model = best.model;
  PointAlignment result;
  result.inliers = best.inliers;
  result.iterations = best.iterations;
  for (int round = 0; round < kRounds && result.inliers.size() >= kMinInliers; ++round) {
    model = problem.minimise(model, result.inliers, kSteps);
    auto next = inliers_of(problem, model, options.max_error_sigmas);
    const bool settled = next == result.inliers;
    result.inliers = std::move(next);
    if (settled) break;
  }
  if (result.inliers.size() < kMinInliers) return std::nullopt;
  result.match_from_query = {Eigen::Quaterniond(model.rotation).normalized(), model.translation};
  result.scale = model.scale;
  if (options.scale == AlignmentScale::Free) {
    state_information<7>(problem, model, options, result);
  } else {
    state_information<6>(problem, model, options, result);
  }
  return result;
}

void validate(const PointNoise& noise, const std::string& side) {
  const bool possible = noise.floor >= 0 && noise.across >= 0 && noise.along >= 0 && noise.along_squared >= 0 &&
                        (noise.floor > 0 || (noise.across > 0 && noise.along + noise.along_squared > 0));
  if (!possible) throw InputError("alignment: the " + side + "'s noise must be positive in every direction; set its floor");
}

void validate(std::span<const PointPair> pairs, const AlignmentOptions& options) {
  validate(options.query_noise, "query");
  validate(options.match_noise, "match");
  if (!(options.max_error_sigmas > 0)) throw InputError("alignment: max_error_sigmas must be positive");
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!pairs[i].in_query.allFinite() || !pairs[i].in_match.allFinite()) {
      throw InputError("alignment: pair " + std::to_string(i) + " is not finite; leave it out");
    }
  }
}

}  // namespace

std::optional<PointAlignment> align_points(std::span<const PointPair> pairs, const AlignmentOptions& options) {
  validate(pairs, options);
  const AlignmentProblem problem(pairs, options);
  const auto best = ransac(problem, {options.max_error_sigmas, options.confidence, options.max_iterations, options.seed});
  if (!best) return std::nullopt;
  return finish(problem, *best, options);
}

}  // namespace fabloop
