// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/solver.h>

#include "posegraph/optimize.h"

namespace fabloop::residuals {

/// How Ceres solves for poses: sparse Cholesky, silently, until the cost no longer falls.
inline ceres::Solver::Options sparse_solver_options(const OptimizeOptions& options) {
  ceres::Solver::Options result;
  result.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  result.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  // Sums over threads would come out in another order each time.
  result.num_threads = 1;
  result.max_num_iterations = options.max_iterations;
  result.function_tolerance = options.cost_tolerance;
  result.gradient_tolerance = 0.0;
  result.logging_type = ceres::SILENT;
  return result;
}

}  // namespace fabloop::residuals
