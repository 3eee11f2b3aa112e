// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"

namespace fabloop {

/// The two surrogates of Yang et al., Graduated Non-Convexity for Robust Spatial Perception, RA-L 2020.
enum class Surrogate { TruncatedLeastSquares, GemanMcClure };

/// Weight of a measurement with squared error `chi2` and threshold `c2` (eq. 14 for truncated least squares, in which mu grows
/// from near 0 to infinity, where it is 0 or 1; eq. 12 for Geman-McClure, in which mu falls to 1).
double graduated_weight(Surrogate surrogate, double chi2, double c2, double mu);

/// The mu at which the surrogate is convex for errors up to `max_chi2` (remark 5).
double convex_mu(Surrogate surrogate, double max_chi2, double c2);

/// What graduate() is given. Vectors have one entry an edge.
struct GraduatedProblem {
  std::vector<double> c2;  ///< Squared threshold of each edge.
  /// To begin with: 1 for the foremost of the doubted edges and 0 for the others, or those of an earlier solve to go on from it.
  std::vector<double> weights;
  std::vector<bool> is_doubted;  ///< The others keep their weight.
  /// Doubted edges that have a say from the beginning; the others join in the end. None when going on from an earlier solve.
  std::vector<bool> is_candidate;
  Surrogate surrogate = Surrogate::TruncatedLeastSquares;
  double factor = 1.4;  ///< Of mu from step to step.
};

/// What graduate() found.
struct GraduatedResult {
  std::vector<double> weights;  ///< One an edge; 0 or 1 for truncated least squares.
  std::size_t num_solves = 0;
  OptimizeReport last_solve;
};

/// Alternates weights and poses while the surrogate turns from convex into the robust cost, first among the candidates and then
/// among all edges whose error is not far beyond their threshold. The poses of the graph must be those of the trusted edges, or
/// of the earlier solve.
GraduatedResult graduate(PoseGraph& graph, const GraduatedProblem& problem, const OptimizeOptions& options);

}  // namespace fabloop
