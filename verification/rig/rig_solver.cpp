// SPDX-License-Identifier: BSD-3-Clause
#include "verification/rig/rig_solver.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <opengv/relative_pose/RelativeAdapterBase.hpp>
#include <opengv/relative_pose/methods.hpp>

#include "verification/pose/essential_poses.h"

namespace fabloop {

/// OpenGV's view of the pairs: viewpoint 1 is the match, 2 the query, and every ray is a camera of its own in the body's axes.
class RigRelativeSolver::Adapter final : public opengv::relative_pose::RelativeAdapterBase {
 public:
  explicit Adapter(std::span<const RigRayPair> pairs) : pairs_(pairs) {}
  opengv::bearingVector_t getBearingVector1(std::size_t i) const override { return pairs_[i].match.ray_in_body; }
  opengv::bearingVector_t getBearingVector2(std::size_t i) const override { return pairs_[i].query.ray_in_body; }
  double getWeight(std::size_t) const override { return 1.0; }
  opengv::translation_t getCamOffset1(std::size_t i) const override { return pairs_[i].match.origin_in_body; }
  opengv::rotation_t getCamRotation1(std::size_t) const override { return opengv::rotation_t::Identity(); }
  opengv::translation_t getCamOffset2(std::size_t i) const override { return pairs_[i].query.origin_in_body; }
  opengv::rotation_t getCamRotation2(std::size_t) const override { return opengv::rotation_t::Identity(); }
  std::size_t getNumberCorrespondences() const override { return pairs_.size(); }

 private:
  std::span<const RigRayPair> pairs_;
};

namespace {

std::vector<int> as_ints(std::span<const std::size_t> sample) {
  std::vector<int> indices;
  indices.reserve(sample.size());
  for (const std::size_t i : sample) indices.push_back(static_cast<int>(i));
  return indices;
}

/// Whether the rays of one point meet in front of two cameras with the given rotation and baseline.
bool in_front(const RigRayPair& pair, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& baseline) {
  RigRayPair central = pair;
  central.query.origin_in_body.setZero();
  central.match.origin_in_body.setZero();
  return meets_in_front(central, {rotation, baseline}, 0.0);
}

/// The decompositions of E = [b]x R that see the whole sample in front.
void append_motions(const Eigen::Matrix3d& essential, std::span<const RigRayPair> pairs, std::span<const std::size_t> sample,
                    std::vector<BodyMotion>& motions) {
  for (const Pose& pose : essential_poses(essential)) {
    const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
    const bool seen =
        std::all_of(sample.begin(), sample.end(), [&](std::size_t i) { return in_front(pairs[i], rotation, pose.translation); });
    if (seen) motions.push_back({rotation, pose.translation});
  }
}

/// The rotation that best turns the query's rays onto the match's: where to start a search for small baselines.
Eigen::Matrix3d rotation_of_rays(std::span<const RigRayPair> pairs, std::span<const std::size_t> sample) {
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (const std::size_t i : sample) correlation += pairs[i].match.ray_in_body * pairs[i].query.ray_in_body.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1.0 : 1.0);
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace

RigRelativeSolver::RigRelativeSolver(std::span<const RigRayPair> pairs)
    : pairs_(pairs), adapter_(std::make_unique<Adapter>(pairs)) {}

RigRelativeSolver::~RigRelativeSolver() = default;

std::vector<BodyMotion> RigRelativeSolver::five_points(std::span<const std::size_t> sample) const {
  std::vector<BodyMotion> motions;
  for (const auto& essential : opengv::relative_pose::fivept_nister(*adapter_, as_ints(sample))) {
    if (essential.allFinite()) append_motions(essential, pairs_, sample, motions);
  }
  return motions;
}

BodyMotion RigRelativeSolver::with_length(const BodyMotion& direction, std::size_t pair_of_direction, double length) const {
  const RigRayPair& pair = pairs_[pair_of_direction];
  // b = t + R c - d
  return {direction.rotation,
          length * direction.translation - direction.rotation * pair.query.origin_in_body + pair.match.origin_in_body};
}

std::optional<BodyMotion> RigRelativeSolver::with_length_from(const BodyMotion& direction, std::size_t pair_of_direction,
                                                              std::size_t sixth) const {
  const RigRayPair& pair = pairs_[sixth];
  const Eigen::Vector3d normal = (direction.rotation * pair.query.ray_in_body).cross(pair.match.ray_in_body);
  const double by_length = normal.dot(direction.translation);
  const double at_zero = normal.dot(baseline_in_match(pair, with_length(direction, pair_of_direction, 0)));
  const double length = -at_zero / by_length;
  if (!std::isfinite(length) || length <= 0) return std::nullopt;
  const BodyMotion motion = with_length(direction, pair_of_direction, length);
  if (!meets_in_front(pair, motion, 0.0)) return std::nullopt;
  return motion;
}

std::optional<BodyMotion> RigRelativeSolver::generalised_eigen(std::span<const std::size_t> sample) const {
  Adapter adapter(pairs_);
  adapter.setR12(rotation_of_rays(pairs_, sample));
  opengv::geOutput_t output;
  output.rotation = adapter.getR12();
  opengv::relative_pose::ge(adapter, as_ints(sample), output);
  const BodyMotion motion{output.rotation, output.translation.head<3>() / output.translation.w()};
  if (!motion.rotation.allFinite() || !motion.translation.allFinite()) return std::nullopt;
  return motion;
}

std::optional<BodyMotion> RigRelativeSolver::seventeen_points(std::span<const std::size_t> sample) const {
  const opengv::transformation_t match_from_query = opengv::relative_pose::seventeenpt(*adapter_, as_ints(sample));
  if (!match_from_query.allFinite()) return std::nullopt;
  return BodyMotion{match_from_query.leftCols<3>(), match_from_query.col(3)};
}

}  // namespace fabloop
