// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/pose_graph.h"
#include "posegraph/robust/noise_factors.h"
#include "posegraph/robust/robust_optimize.h"
#include "posegraph/robust/weighted_solve.h"

namespace fabloop {

/// What each edge is before anything is solved.
struct LoopRoles {
  std::vector<EdgeVerdict> forced;  ///< Trusted, ForcedAccept or ForcedReject; Kept where it is to be decided.
  std::vector<bool> is_doubted;     ///< To be decided.
  std::vector<double> c2;           ///< Squared threshold.
  double noise_scale = 1.0;
};

/// What a back end found, before verdicts.
struct BackEndSolution {
  OptimizeReport last_solve;
  std::vector<double> weights;
  std::size_t num_solves = 1;
  bool is_proven = true;
  NoiseFactors noise = {};
};

/// The roles that the options give to the edges. Throws InputError for forced edges that are not there, are trusted, or are both
/// accepted and rejected.
LoopRoles roles_of(const PoseGraph& graph, const RobustOptions& options);

/// The weights with which every loop to be decided has `weight`.
EdgeWeights weights_of(const LoopRoles& roles, double weight);

}  // namespace fabloop
