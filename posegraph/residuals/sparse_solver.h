// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "posegraph/optimize.h"
#include "posegraph/robust_loss.h"

namespace fabloop::residuals {

/// A robust loss in Ceres' clothes, with the square of its scale.
class Loss final : public ceres::LossFunction {
 public:
  Loss(RobustLoss loss, double c2) : loss_(loss), c2_(c2) {}
  void Evaluate(double s, double rho[3]) const override {
    rho[0] = robust_cost(loss_, s, c2_);
    rho[1] = robust_weight(loss_, s, c2_);
    rho[2] = robust_curvature(loss_, s, c2_);
  }

 private:
  RobustLoss loss_;
  double c2_;
};

/// A problem that owns neither costs, losses nor manifolds.
inline ceres::Problem::Options unowned() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

/// How a solve ended.
struct SolverRun {
  Termination termination = Termination::Failed;
  int iterations = 0;
  double initial_cost = 0.0;  ///< Sums without the factor 1/2 that Ceres prints.
  double final_cost = 0.0;
};

/// Sparse Cholesky steps on one thread, silently, until the cost no longer falls, with the progress and the cancelling of the
/// options. `start`: where the poses are, which says how far steps may go.
SolverRun run(const OptimizeOptions& options, Initialization start, ceres::Problem& problem);

}  // namespace fabloop::residuals
