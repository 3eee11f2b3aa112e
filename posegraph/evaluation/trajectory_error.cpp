// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/evaluation/trajectory_error.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace fabloop {
namespace {

Eigen::Matrix3Xd centres(const std::vector<PosePair>& pairs, const Pose& (*pose_of)(const PosePair&)) {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) result.col(static_cast<Eigen::Index>(i)) = pose_of(pairs[i]).translation;
  return result;
}

const Pose& estimate_of(const PosePair& pair) { return pair.estimate.world_from_camera; }
const Pose& reference_of(const PosePair& pair) { return pair.reference_from_camera; }

/// Index in `trajectory` of the pose nearest in time.
std::size_t nearest(const Trajectory& trajectory, std::int64_t time_ns) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), time_ns,
                                      [](const StampedPose& stamped, std::int64_t time) { return stamped.time_ns < time; });
  const auto index = static_cast<std::size_t>(after - trajectory.begin());
  if (index == trajectory.size()) return index - 1;
  if (index > 0 && time_ns - trajectory[index - 1].time_ns <= trajectory[index].time_ns - time_ns) return index - 1;
  return index;
}

/// Pairs of positions that a relative error spans: neighbours, or stretches that lie end to end along the reference's path. As in
/// evo, the first begins where the path has the length for the first time, not at its start.
std::vector<std::pair<std::size_t, std::size_t>> steps(const std::vector<PosePair>& pairs, double segment_length_m) {
  std::vector<std::size_t> ends;
  double length = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (i > 0) length += (reference_of(pairs[i]).translation - reference_of(pairs[i - 1]).translation).norm();
    if (segment_length_m > 0.0 && length < segment_length_m) continue;
    ends.push_back(i);
    length = 0.0;
  }
  std::vector<std::pair<std::size_t, std::size_t>> result;
  for (std::size_t k = 1; k < ends.size(); ++k) result.emplace_back(ends[k - 1], ends[k]);
  return result;
}

/// The turn about z that aligns centred points best, from their 3 x 3 covariance (reference by estimate).
Eigen::Matrix3d best_yaw(const Eigen::Matrix3d& covariance) {
  const double yaw = std::atan2(covariance(1, 0) - covariance(0, 1), covariance(0, 0) + covariance(1, 1));
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

}  // namespace

ErrorStatistics error_statistics(std::vector<double> errors) {
  ErrorStatistics result;
  result.count = errors.size();
  if (errors.empty()) return result;
  const auto count = static_cast<double>(errors.size());
  double sum = 0.0;
  double squared_sum = 0.0;
  for (const double error : errors) {
    sum += error;
    squared_sum += error * error;
  }
  std::sort(errors.begin(), errors.end());
  result.mean = sum / count;
  result.rmse = std::sqrt(squared_sum / count);
  result.max = errors.back();
  const std::size_t half = errors.size() / 2;
  result.median = errors.size() % 2 == 1 ? errors[half] : 0.5 * (errors[half - 1] + errors[half]);
  return result;
}

std::vector<PosePair> associate(const Trajectory& estimate, const Trajectory& reference, double max_time_difference_s) {
  const bool estimate_is_shorter = estimate.size() <= reference.size();
  const Trajectory& shorter = estimate_is_shorter ? estimate : reference;
  const Trajectory& longer = estimate_is_shorter ? reference : estimate;
  const auto max_difference_ns = static_cast<std::int64_t>(std::llround(max_time_difference_s * 1e9));
  if (shorter.empty()) return {};
  std::vector<std::pair<std::size_t, std::size_t>> matches;
  for (std::size_t i = 0; i < shorter.size(); ++i) {
    const std::size_t j = nearest(longer, shorter[i].time_ns);
    if (std::abs(shorter[i].time_ns - longer[j].time_ns) <= max_difference_ns) matches.emplace_back(i, j);
  }
  std::vector<PosePair> pairs;
  for (const auto& [i, j] : matches) {
    const StampedPose& of_estimate = estimate_is_shorter ? shorter[i] : longer[j];
    const StampedPose& of_reference = estimate_is_shorter ? longer[j] : shorter[i];
    pairs.push_back({of_estimate, of_reference.world_from_camera});
  }
  return pairs;
}

std::optional<Similarity> align_points(const Eigen::Matrix3Xd& estimate, const Eigen::Matrix3Xd& reference, Alignment alignment) {
  if (alignment == Alignment::None) return Similarity{};
  if (estimate.cols() != reference.cols() || estimate.cols() < 2) return std::nullopt;
  const Eigen::Vector3d mean_estimate = estimate.rowwise().mean();
  const Eigen::Vector3d mean_reference = reference.rowwise().mean();
  const Eigen::Matrix3Xd centred_estimate = estimate.colwise() - mean_estimate;
  const Eigen::Matrix3Xd centred_reference = reference.colwise() - mean_reference;
  const double spread = centred_estimate.squaredNorm();
  if (!(spread > 0.0)) return std::nullopt;
  const Eigen::Matrix3d covariance = centred_reference * centred_estimate.transpose();
  if (alignment == Alignment::Yaw) {
    const Eigen::Matrix3d rotation = best_yaw(covariance);
    return Similarity{1.0, Eigen::Quaterniond(rotation), mean_reference - rotation * mean_estimate};
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs(2) = -1.0;
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  const double scale = alignment == Alignment::Sim3 ? svd.singularValues().dot(signs) / spread : 1.0;
  return Similarity{scale, Eigen::Quaterniond(rotation), mean_reference - scale * rotation * mean_estimate};
}

std::optional<AbsoluteTrajectoryError> absolute_trajectory_error(const Trajectory& estimate, const Trajectory& reference,
                                                                 const TrajectoryErrorOptions& options) {
  constexpr std::size_t kMinPoses = 3;
  const std::vector<PosePair> pairs = associate(estimate, reference, options.max_time_difference_s);
  if (pairs.size() < kMinPoses) return std::nullopt;
  const auto similarity = align_points(centres(pairs, estimate_of), centres(pairs, reference_of), options.alignment);
  if (!similarity) return std::nullopt;
  std::vector<double> errors;
  errors.reserve(pairs.size());
  for (const PosePair& pair : pairs) {
    errors.push_back((*similarity * estimate_of(pair).translation - reference_of(pair).translation).norm());
  }
  return AbsoluteTrajectoryError{error_statistics(std::move(errors)), *similarity};
}

std::optional<RelativePoseError> relative_pose_error(const Trajectory& estimate, const Trajectory& reference,
                                                     const TrajectoryErrorOptions& options) {
  const std::vector<PosePair> pairs = associate(estimate, reference, options.max_time_difference_s);
  double scale = 1.0;
  if (options.alignment == Alignment::Sim3) {
    const auto similarity = align_points(centres(pairs, estimate_of), centres(pairs, reference_of), options.alignment);
    if (!similarity) return std::nullopt;
    scale = similarity->scale;
  }
  std::vector<double> translation_m;
  std::vector<double> rotation_deg;
  for (const auto& [a, b] : steps(pairs, options.segment_length_m)) {
    Pose estimate_a_from_b = estimate_of(pairs[a]).inverse() * estimate_of(pairs[b]);
    estimate_a_from_b.translation *= scale;
    const Pose reference_a_from_b = reference_of(pairs[a]).inverse() * reference_of(pairs[b]);
    const Pose error = reference_a_from_b.inverse() * estimate_a_from_b;
    translation_m.push_back(error.translation.norm());
    rotation_deg.push_back(deg_from_rad(rotation_angle(error.rotation)));
  }
  if (translation_m.empty()) return std::nullopt;
  return RelativePoseError{error_statistics(std::move(translation_m)), error_statistics(std::move(rotation_deg))};
}

}  // namespace fabloop
