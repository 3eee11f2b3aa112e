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
  std::vector<double> c2;    ///< Squared threshold of each edge.
  double noise_scale = 1.0;  ///< What they were multiplied with, for noise below what the information says.
  /// To begin with: 1 for the foremost of the doubted edges and 0 for the others, or those of an earlier solve to go on from it.
  std::vector<double> weights;
  std::vector<bool> is_doubted;  ///< The others keep their weight.
  /// Doubted edges that have a say from the beginning; the others join in the end. None when going on from an earlier solve.
  std::vector<bool> is_candidate;
  Surrogate surrogate = Surrogate::TruncatedLeastSquares;
  double factor = 1.4;  ///< Of mu from step to step.
  /// Lower thresholds once the candidates are solved, where they and the trusted edges agree better than their information says:
  /// see variance_factor(). False where the information is honest.
  bool learns_noise = false;
};

/// What graduate() found.
struct GraduatedResult {
  std::vector<double> weights;  ///< One an edge; 0 or 1 for truncated least squares.
  std::size_t num_solves = 0;
  OptimizeReport last_solve;
  double threshold_factor = 1.0;  ///< What thresholds were multiplied with in the end, at most 1.
};

/// The a posteriori variance of unit weight over the edges of weight above one half: their errors over how many of them are
/// redundant, so that a map with few loops, which bends to all of them, does not look exact (Mikhail & Ackermann, Observations
/// and Least Squares, 1976, section 10.2). 1 where it is not below 1 beyond chance, or with fewer than 100 redundant errors.
double variance_factor(const PoseGraph& graph, const std::vector<double>& weights, const std::vector<double>& chi2,
                       std::size_t num_held);

/// Alternates weights and poses while the surrogate turns from convex into the robust cost, first among the candidates and then
/// among all edges whose error is not far beyond their threshold. The poses of the graph must be those of the trusted edges, or
/// of the earlier solve.
GraduatedResult graduate(PoseGraph& graph, const GraduatedProblem& problem, const OptimizeOptions& options);

}  // namespace fabloop
