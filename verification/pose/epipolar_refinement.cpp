// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/epipolar_refinement.h"

#include "verification/pose/residuals.h"

namespace fabloop {
namespace {

Pose moved_across_directions(const Pose& match_from_query, const Eigen::Matrix<double, 5, 1>& step) {
  const Eigen::Matrix<double, 3, 2> basis = direction_axes(match_from_query.translation);
  return {(match_from_query.rotation * rotation_from_vector(step.head<3>())).normalized(),
          (match_from_query.translation + basis * step.tail<2>()).normalized()};
}

}  // namespace

Eigen::Matrix<double, 3, 2> direction_axes(const Eigen::Vector3d& direction) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = direction.unitOrthogonal();
  basis.col(1) = direction.cross(basis.col(0)).normalized();
  return basis;
}

EpipolarFrame frame_of(const Pose& match_from_query) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  EpipolarFrame frame;
  Eigen::Map<RowMajor>(frame.rotation.data()) = match_from_query.rotation.toRotationMatrix();
  Eigen::Map<Eigen::Vector3d>(frame.translation.data()) = match_from_query.translation;
  Eigen::Map<RowMajor>(frame.essential.data()) = essential_matrix(match_from_query);
  Eigen::Map<Eigen::Matrix<double, 3, 2>>(frame.basis.data()) = direction_axes(match_from_query.translation);
  return frame;
}

EpipolarEquations equations_of(std::span<const RayPair> pairs) {
  EpipolarEquations equations(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) equations.set(i, pairs[i].query.data(), pairs[i].match.data());
  return equations;
}

EpipolarEquations equations_of(std::span<const RayPair> pairs, std::span<const std::size_t> indices,
                               std::span<const double> weights) {
  EpipolarEquations equations(indices.size());
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const RayPair& pair = pairs[indices[k]];
    equations.set(k, pair.query.data(), pair.match.data(), weights.empty() ? 1.0 : weights[indices[k]]);
  }
  return equations;
}

NormalEquations<5> linearise(const EpipolarEquations& equations, const Pose& match_from_query) {
  const EpipolarSums sums = equations.linearise(frame_of(match_from_query));
  NormalEquations<5> normal;
  std::size_t next = 0;
  for (Eigen::Index row = 0; row < 5; ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      normal.hessian(row, column) = normal.hessian(column, row) = sums.hessian[next++];
    }
  }
  normal.gradient = Eigen::Map<const Eigen::Matrix<double, 5, 1>>(sums.gradient.data());
  normal.cost = sums.cost;
  return normal;
}

Pose minimise(const EpipolarEquations& equations, const Pose& match_from_query, int max_steps) {
  return levenberg_marquardt<5>(
      match_from_query, [&](const Pose& pose) { return linearise(equations, pose); }, moved_across_directions, max_steps);
}

}  // namespace fabloop
