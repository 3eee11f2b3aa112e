// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"

namespace fabloop {

/// How the doubted edges of a graph enter a solve.
struct EdgeWeights {
  /// Part of each edge's information that counts; an edge of weight 0 is left out.
  std::vector<double> weights;
  /// Edges that get the robust loss of the options; the others have none.
  std::vector<bool> has_loss;
};

/// optimize() on the edges that have a weight, with their information scaled by it and, for the losses, divided by
/// `noise_scale`, as that of the priors is. The report's edges are those edges.
OptimizeReport solve_weighted(PoseGraph& graph, const EdgeWeights& edges, OptimizeOptions options, double noise_scale = 1.0);

/// Where to begin anew: the chordal relaxation, where it keeps the freedom of the options.
Initialization relaxation_of(const OptimizeOptions& options);

/// Squared threshold of every edge: what the chi-square of a right one stays below with `probability`.
std::vector<double> thresholds(const PoseGraph& graph, double probability);

/// Squared whitened error of every edge as the graph stands, without weights or losses.
std::vector<double> evaluate_chi2(const PoseGraph& graph, Objective objective);

}  // namespace fabloop
