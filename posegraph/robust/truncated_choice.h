// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"

namespace fabloop {

/// A choice of loops to be judged by the truncated cost: sum of chi2 over the edges that are not doubted, and of min(chi2, c2)
/// over those that are. Vectors have one entry an edge.
struct TruncatedProblem {
  std::vector<double> c2;
  std::vector<bool> is_doubted;
  std::vector<double> weights;  ///< 1 where the edge counts, 0 where it is left out; only doubted edges are exchanged.
};

/// Poses with the loops chosen for them. Vectors have one entry a vertex or an edge.
struct TruncatedChoice {
  std::vector<Vertex> vertices;
  std::vector<double> weights;  ///< 0 or 1 for doubted edges.
  std::vector<double> chi2;     ///< Of all edges at these poses.
  double cost = 0.0;            ///< The truncated cost.
  double fitted_cost = 0.0;     ///< Of it, what is not of loops that are left out: as exact as the solve.
  std::size_t num_solves = 0;
};

/// The truncated cost of edges with these squared errors.
double truncated_cost(const TruncatedProblem& problem, const std::vector<double>& chi2);

/// Solves for the weights of the problem and chooses by its thresholds in turns, from the graph's poses, until the choice
/// stays, or is that of `known_weights`, which the caller has settled already. `optimize` says where to begin.
TruncatedChoice settle(PoseGraph graph, const TruncatedProblem& problem, OptimizeOptions optimize,
                       const std::vector<double>& known_weights = {});

/// Settles with the loops let in whose errors are up to three times those that thresholds allow, since a map without them shows
/// their error and its own; and without these where that costs more than the poses given.
TruncatedChoice settle_wider(const PoseGraph& graph, const TruncatedProblem& problem, const OptimizeOptions& optimize);

}  // namespace fabloop
