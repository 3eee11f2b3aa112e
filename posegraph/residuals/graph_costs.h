// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>

#include <memory>
#include <vector>

#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"
#include "posegraph/solver_state.h"

namespace fabloop {

/// Which loss an edge has, and the square of its scale.
struct EdgeLoss {
  RobustLoss loss = RobustLoss::None;
  double c2 = 1.0;
};

/// The residuals and losses of a graph under some options. Priors have no loss: what is doubted is an edge.
class GraphCosts {
 public:
  using Residuals = std::vector<std::unique_ptr<ceres::CostFunction>>;

  /// Keeps a reference to the graph.
  GraphCosts(const PoseGraph& graph, const OptimizeOptions& options);

  const Residuals& edge_residuals() const { return edge_residuals_; }
  const Residuals& prior_residuals() const { return prior_residuals_; }
  const std::vector<EdgeLoss>& losses() const { return losses_; }

  std::vector<EdgeResult> evaluate_edges(std::vector<State>& states) const;
  std::vector<EdgeResult> evaluate_priors(std::vector<State>& states) const;
  double sum(const std::vector<EdgeResult>& edges, const std::vector<EdgeResult>& priors) const;

  /// The parameter blocks of a prior's residual.
  std::vector<double*> blocks_of_prior(const VertexPrior& prior, std::vector<State>& states) const;
  /// Where a prior's residual finds the world: to be held.
  std::vector<double*> world_blocks() const;

 private:
  const PoseGraph& graph_;
  Residuals edge_residuals_;
  Residuals prior_residuals_;
  std::vector<EdgeLoss> losses_;
  std::unique_ptr<State> world_;
};

}  // namespace fabloop
