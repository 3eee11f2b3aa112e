// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/pose_graph.h"
#include "posegraph/robust/noise_factors.h"
#include "posegraph/robust/robust_optimize.h"

namespace fabloop {

/// What refine_choice() ended with.
struct RefinedChoice {
  std::vector<double> weights;  ///< 0 or 1 for doubted edges, as given for the others.
  NoiseFactors noise;           ///< By which the errors were judged.
  std::size_t num_solves = 0;
};

/// Improves a choice of loops at poses that fit it: says how large errors really are (`NoiseScale::Observed`), and exchanges
/// clusters of loops under that noise, in turns. Once the noise is known, it is a right loop lost that costs, so that one may be
/// lost with the square of the probability that `inlier_probability` leaves (once in 10,000 times for 0.99). In the end loops
/// beyond that come in where they are likelier right than false (even_odds_chi2()), all those at once. The poses are then those
/// of the graph with the noise as it was found to be. Vectors have one entry an edge.
RefinedChoice refine_choice(PoseGraph& graph, std::vector<double> weights, const std::vector<bool>& is_doubted,
                            const RobustOptions& options);

}  // namespace fabloop
