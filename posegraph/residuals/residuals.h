// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>

#include <memory>

#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"
#include "posegraph/residuals/attitude_residual.h"
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

/// The residual of a prior: block (q) for an attitude, else the blocks of an edge from the world, which is held, to the vertex. A
/// prior is whitened under every objective: under Chordal as under Quaternion, which is the same for isotropic information.
inline std::unique_ptr<ceres::CostFunction> make_residual(const VertexPrior& prior, int dimension, Objective objective) {
  if (prior.kind == PriorKind::Attitude) return std::make_unique<AttitudeResidual>(prior);
  Edge edge;
  edge.from_from_to = prior.world_from_frame;
  edge.information = prior.information;
  if (prior.kind == PriorKind::Position) {
    // Then the frame in which the information lives is the world's.
    edge.from_from_to.rotation.setIdentity();
    edge.information.setZero();
    edge.information.topLeftCorner<3, 3>() = prior.information.topLeftCorner<3, 3>();
  }
  return make_residual(edge, dimension, objective == Objective::Chordal ? Objective::Quaternion : objective);
}

}  // namespace fabloop::residuals
