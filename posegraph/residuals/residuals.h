// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>

#include <memory>

#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"
#include "posegraph/residuals/planar_residual.h"
#include "posegraph/residuals/spatial_residual.h"

/// The errors of edges, for Ceres. In 3-D a pose is two blocks: the quaternion in Eigen's storage (x y z w) and the
/// translation; in 2-D one block (x, y, yaw).
namespace fabloop::residuals {

/// No edge has more errors than this.
inline constexpr int kMaxSize = 6;

/// The residual of an edge: blocks (q_i, t_i, q_j, t_j) in 3-D, (pose_i, pose_j) in 2-D. Derivatives are analytic.
inline std::unique_ptr<ceres::CostFunction> make_residual(const Edge& edge, int dimension, Objective objective) {
  if (dimension == 2) return std::make_unique<PlanarResidual>(edge, objective);
  return std::make_unique<SpatialResidual>(edge, objective);
}

}  // namespace fabloop::residuals
