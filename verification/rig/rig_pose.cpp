// SPDX-License-Identifier: BSD-3-Clause
#include "verification/rig/rig_pose.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "frontend/error.h"
#include "verification/pose/pose_step.h"
#include "verification/pose/truncated_noise.h"
#include "verification/rig/camera_pair_groups.h"
#include "verification/rig/rig_epipolar.h"
#include "verification/rig/rig_solver.h"
#include "verification/rig/sampled_ransac.h"

namespace fabloop {
namespace {

constexpr std::size_t kMinInliers = 7;  ///< One more than the pose has degrees of freedom.

NormalEquations<6> linearise(std::span<const RigRayPair> pairs, std::span<const std::size_t> indices, const Pose& pose) {
  const BodyMotion motion = BodyMotion::from(pose);
  NormalEquations<6> normal;
  for (const std::size_t i : indices) add_rig_residual(pairs[i], motion, normal);
  return normal;
}

/// By a step of (translation, rotation) in the query's axes.
Pose minimise(std::span<const RigRayPair> pairs, std::span<const std::size_t> indices, const Pose& pose, int max_steps) {
  return levenberg_marquardt<6>(
      pose, [&](const Pose& at) { return linearise(pairs, indices, at); }, moved_in_own_frame, max_steps);
}

/// Root mean square distance of the cameras from the first of them, of both bodies.
double spread_of_origins(std::span<const RigRayPair> pairs) {
  double sum = 0;
  for (const RigRayPair& pair : pairs) {
    sum += (pair.query.origin_in_body - pairs[0].query.origin_in_body).squaredNorm() +
           (pair.match.origin_in_body - pairs[0].match.origin_in_body).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(pairs.size()));
}

class RigRelativeProblem {
 public:
  using Model = BodyMotion;
  static constexpr std::size_t kSampleSize = 6;

  RigRelativeProblem(std::span<const RigRayPair> pairs, double max_error_rad, RigSolver wanted)
      : pairs_(pairs), max_error_rad_(max_error_rad), solver_(pairs), groups_(group_by_camera_pair(pairs)) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (members_of_group(i).size() >= kFive) drawable_.push_back(i);
    }
    kind_ = wanted;
    if (wanted == RigSolver::Automatic) kind_ = drawable_.empty() ? RigSolver::GeneralisedEigen : RigSolver::FivePlusOne;
    const double spread = spread_of_origins(pairs);
    length_without_scale_ = spread > 0 ? spread : 1.0;
  }

  std::size_t size() const { return pairs_.size(); }
  RigSolver kind() const { return kind_; }

  /// A pair that agrees but whose rays meet behind a camera is as wrong as can be.
  auto evaluator(const BodyMotion& motion) const {
    return [this, motion](std::size_t i) {
      const double squared = squared_rig_error(pairs_[i], motion);
      const bool within = squared < max_error_rad_ * max_error_rad_;
      return within && !meets_in_front(pairs_[i], motion, max_error_rad_) ? 1.0 : squared;
    };
  }

  std::vector<BodyMotion> propose(std::mt19937_64& random) const {
    if (kind_ == RigSolver::FivePlusOne) return propose_five_plus_one(random);
    const bool is_eigen = kind_ == RigSolver::GeneralisedEigen;
    const std::size_t count = is_eigen ? kEight : kSeventeen;
    if (pairs_.size() < count) return {};
    std::vector<std::size_t> sample;
    while (sample.size() < count) add_if_new(sample, random() % pairs_.size());
    const auto motion = is_eigen ? solver_.generalised_eigen(sample) : solver_.seventeen_points(sample);
    return motion ? std::vector<BodyMotion>{*motion} : std::vector<BodyMotion>{};
  }

  double p_good_sample(const std::vector<std::size_t>& inliers) const {
    const double share = static_cast<double>(inliers.size()) / static_cast<double>(pairs_.size());
    if (kind_ == RigSolver::GeneralisedEigen) return std::pow(share, kEight);
    if (kind_ == RigSolver::SeventeenPoint) return std::pow(share, kSeventeen);
    return p_good_five_plus_one(inliers);
  }

  /// From the data within some times the threshold down to those within it (LO-RANSAC's iterative step): a length taken from one
  /// pair is too rough to have all inliers at once.
  BodyMotion refine(const BodyMotion& motion) const {
    constexpr int kLocalSteps = 4;
    Pose pose = motion.pose();
    for (const double factor : {4.0, 2.0}) {
      pose = minimise(pairs_, inliers_of(*this, BodyMotion::from(pose), factor * max_error_rad_), pose, kLocalSteps);
    }
    return BodyMotion::from(minimise(pairs_, inliers_of(*this, BodyMotion::from(pose), max_error_rad_), pose, kLocalSteps));
  }

 private:
  static constexpr std::size_t kFive = 5, kEight = 8, kSeventeen = 17;
  /// Lengths are cheap beside five points: several are tried, so that one of them is an inlier's.
  static constexpr int kSixths = 6;

  const std::vector<std::size_t>& members_of_group(std::size_t pair) const { return groups_.members[groups_.group_of[pair]]; }

  static void add_if_new(std::vector<std::size_t>& sample, std::size_t i) {
    if (std::find(sample.begin(), sample.end(), i) == sample.end()) sample.push_back(i);
  }

  /// Half of the samples come from all pairs, the other half from the best of them, however many these be: PROSAC's idea (Chum &
  /// Matas 2005) without its schedule, which would have to know the group's share of the draws.
  static double random_exponent(std::mt19937_64& random) {
    const double uniform = static_cast<double>(random() >> 11) * 0x1.0p-53;  // in [0, 1)
    return std::min(1.0, 2.0 * uniform);
  }

  /// How many of the best of `count` pairs: all for the exponent 1, at least ten.
  static std::size_t best_of(std::size_t count, double exponent) {
    constexpr double kLeast = 10;
    const auto all = static_cast<double>(count);
    return all <= kLeast ? count : static_cast<std::size_t>(std::lround(kLeast * std::pow(all / kLeast, exponent)));
  }

  /// Two cameras are drawn as often as they share pairs. Besides the lengths that sixth pairs ask for, one stands for all where
  /// the scale does not matter.
  std::vector<BodyMotion> propose_five_plus_one(std::mt19937_64& random) const {
    if (drawable_.empty()) return {};
    const double exponent = random_exponent(random);
    const std::size_t first = drawable_[random() % best_of(drawable_.size(), exponent)];
    const std::vector<std::size_t>& members = members_of_group(first);
    std::vector<std::size_t> sample{first};
    while (sample.size() < kFive) add_if_new(sample, members[random() % best_of(members.size(), exponent)]);
    std::vector<BodyMotion> motions;
    for (const BodyMotion& direction : solver_.five_points(sample)) {
      motions.push_back(solver_.with_length(direction, first, length_without_scale_));
      if (members.size() == pairs_.size()) continue;
      for (int i = 0; i < kSixths; ++i) {
        const std::size_t sixth = random() % pairs_.size();
        if (groups_.group_of[sixth] == groups_.group_of[first]) continue;
        if (const auto motion = solver_.with_length_from(direction, first, sixth)) motions.push_back(*motion);
      }
    }
    return motions;
  }

  /// Over the groups: that one is drawn, that five of it are inliers, and that one of the sixths is.
  double p_good_five_plus_one(const std::vector<std::size_t>& inliers) const {
    std::vector<double> inliers_in(groups_.members.size(), 0.0);
    for (const std::size_t i : inliers) inliers_in[groups_.group_of[i]] += 1.0;
    double p_good = 0;
    for (std::size_t g = 0; g < inliers_in.size(); ++g) {
      const auto size = static_cast<double>(groups_.members[g].size());
      if (size < kFive) continue;
      const double p_sixth = (static_cast<double>(inliers.size()) - inliers_in[g]) / static_cast<double>(pairs_.size());
      const double p_length = groups_.members.size() == 1 ? 1.0 : 1.0 - std::pow(1.0 - p_sixth, kSixths);
      p_good += size / static_cast<double>(drawable_.size()) * std::pow(inliers_in[g] / size, kFive) * p_length;
    }
    return p_good;
  }

  std::span<const RigRayPair> pairs_;
  double max_error_rad_;
  RigRelativeSolver solver_;
  CameraPairGroups groups_;
  std::vector<std::size_t> drawable_;  ///< Pairs whose two cameras share at least five.
  RigSolver kind_ = RigSolver::Automatic;
  double length_without_scale_ = 1.0;
};

/// See RigRelativePose::scale_sigma.
double relative_translation_sigma(const RigRelativePose& result, std::span<const RigRayPair> pairs) {
  const Eigen::Matrix3d of_translation = result.information.topLeftCorner<3, 3>();
  const Eigen::Matrix3d mixed = result.information.topRightCorner<3, 3>();
  const Eigen::Matrix3d of_rotation = result.information.bottomRightCorner<3, 3>();
  const Eigen::Matrix3d marginal = of_translation - mixed * of_rotation.ldlt().solve(mixed.transpose());
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(marginal).eigenvalues()(0);
  const BodyMotion motion = BodyMotion::from(result.match_from_query);
  double squared_baselines = 0;
  for (const std::size_t i : result.inliers) squared_baselines += baseline_in_match(pairs[i], motion).squaredNorm();
  const double baseline = std::sqrt(squared_baselines / static_cast<double>(result.inliers.size()));
  // Beyond the rounding of the subtraction above.
  constexpr double kRounding = 1e-12;
  if (!(least > kRounding * of_translation.trace())) return std::numeric_limits<double>::infinity();
  return 1.0 / (std::sqrt(least) * baseline);
}

std::optional<RigRelativePose> finish(const RigRelativeProblem& problem, std::span<const RigRayPair> pairs,
                                      const RansacResult<BodyMotion>& best, const RigRelativePoseOptions& options) {
  constexpr int kRounds = 4;
  constexpr int kSteps = 20;
  const auto inliers_at = [&](const Pose& pose) { return inliers_of(problem, BodyMotion::from(pose), options.max_error_rad); };
  const auto cost_at = [&](const Pose& pose) {
    return msac_cost(problem, BodyMotion::from(pose), options.max_error_rad, std::numeric_limits<double>::infinity());
  };
  RigRelativePose result;
  result.match_from_query = best.model.pose();
  result.inliers = best.inliers;
  for (int round = 0; round < kRounds && result.inliers.size() >= kMinInliers; ++round) {
    const Pose next = minimise(pairs, result.inliers, result.match_from_query, kSteps);
    // Without scale the distances do not keep a step from putting the points behind the cameras.
    if (cost_at(next) > cost_at(result.match_from_query)) break;
    result.match_from_query = next;
    auto inliers = inliers_at(next);
    const bool settled = inliers == result.inliers;
    result.inliers = std::move(inliers);
    if (settled) break;
  }
  if (result.inliers.size() < kMinInliers) return std::nullopt;
  const NormalEquations<6> normal = linearise(pairs, result.inliers, result.match_from_query);
  constexpr double kMinVariance = 1e-14;
  const auto num_inliers = static_cast<double>(result.inliers.size());
  result.information =
      noise_from_inliers<1>(normal.cost / (num_inliers - 6.0), options.max_error_rad, kMinVariance).information_scale() *
      normal.hessian;
  result.rms_error_rad = std::sqrt(normal.cost / num_inliers);
  result.iterations = best.iterations;
  result.solver = problem.kind();
  result.scale_sigma = relative_translation_sigma(result, pairs);
  result.has_scale = result.scale_sigma <= options.max_scale_sigma;
  return result;
}

void validate(std::span<const RigRayPair> pairs, const RigRelativePoseOptions& options) {
  if (!(options.max_error_rad > 0)) throw InputError("rig relative pose: max_error_rad must be positive");
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const bool finite = pairs[i].query.origin_in_body.allFinite() && pairs[i].query.ray_in_body.allFinite() &&
                        pairs[i].match.origin_in_body.allFinite() && pairs[i].match.ray_in_body.allFinite();
    if (!finite) throw InputError("rig relative pose: pair " + std::to_string(i) + " is not finite; leave it out");
  }
}

}  // namespace

std::optional<RigRelativePose> estimate_rig_relative_pose(std::span<const RigRayPair> pairs,
                                                          const RigRelativePoseOptions& options) {
  validate(pairs, options);
  if (pairs.size() < kMinInliers) return std::nullopt;
  const RigRelativeProblem problem(pairs, options.max_error_rad, options.solver);
  const auto best = sampled_ransac(problem, {options.max_error_rad, options.confidence, options.max_iterations, options.seed});
  if (!best) return std::nullopt;
  return finish(problem, pairs, *best, options);
}

}  // namespace fabloop
