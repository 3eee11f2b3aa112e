// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>

namespace fabloop {

/// Gauss-Newton's view of a sum of squared residuals: J^T J, J^T r and r^T r.
template <int kDimension>
struct NormalEquations {
  Eigen::Matrix<double, kDimension, kDimension> hessian = Eigen::Matrix<double, kDimension, kDimension>::Zero();
  Eigen::Matrix<double, kDimension, 1> gradient = Eigen::Matrix<double, kDimension, 1>::Zero();
  double cost = 0;
};

/// Minimises by Levenberg-Marquardt from `state`: `linearise(state) -> NormalEquations<kDimension>`, `move(state, step) ->
/// state`. For the few parameters of two views; whole graphs go to Ceres.
template <int kDimension, typename State, typename Linearise, typename Move>
State levenberg_marquardt(State state, const Linearise& linearise, const Move& move, int max_steps) {
  constexpr double kMaxDamping = 1e6;
  constexpr double kMinDamping = 1e-9;
  constexpr double kRelativeDecrease = 1e-9;
  double damping = 1e-4;
  NormalEquations<kDimension> normal = linearise(state);
  for (int step = 0; step < max_steps && damping < kMaxDamping; ++step) {
    auto damped = normal.hessian;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-12;
    const Eigen::Matrix<double, kDimension, 1> delta = -damped.ldlt().solve(normal.gradient);
    if (!delta.allFinite()) break;
    const State candidate = move(state, delta);
    const NormalEquations<kDimension> at_candidate = linearise(candidate);
    if (at_candidate.cost < normal.cost) {
      const bool converged = normal.cost - at_candidate.cost < kRelativeDecrease * normal.cost;
      state = candidate;
      normal = at_candidate;
      damping = std::max(kMinDamping, damping * 0.1);
      if (converged) break;
    } else {
      damping *= 10.0;
    }
  }
  return state;
}

}  // namespace fabloop
