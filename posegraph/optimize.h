// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "frontend/progress.h"
#include "posegraph/initialization.h"
#include "posegraph/pose_graph.h"
#include "posegraph/robust_loss.h"

namespace fabloop {

/// Which error of an edge is squared. Their optima differ (slightly, where the noise is small): compare solutions only
/// under one of them. The formulas are in this folder's README.
enum class Objective {
  /// kappa |R_j - R_i R_ij|_F^2 + tau |t_j - t_i - R_i t_ij|^2 (SE-Sync, Rosen et al., IJRR 2019, problem 1). Isotropic: only
  /// the traces of the covariance blocks count. The widest basin of convergence.
  Chordal,
  /// (t, Log R) of the error pose, weighed by the whole information matrix: maximum likelihood for Gaussian noise on SO(3).
  RotationVector,
  /// (t, 2 vec(q)) of the error pose, weighed by the whole information matrix: what Ceres' own pose-graph example minimises.
  Quaternion,
};

/// What of a pose may move.
enum class Freedom {
  Full,
  YawAndPosition,  ///< Four degrees of freedom: roll and pitch are known from gravity and stay. In 2-D the same as Full.
};

/// How optimize() ended.
enum class Termination {
  Converged,      ///< The cost no longer falls.
  MaxIterations,  ///< Stopped by `OptimizeOptions::max_iterations` while the cost was still falling.
  Cancelled,      ///< Stopped by `OptimizeOptions::cancelled`; the poses are the best so far.
  Failed,         ///< The solver found no usable step; the poses are as they were.
  NothingToDo,    ///< No edge, or no free vertex.
};

/// What optimize() may be told.
struct OptimizeOptions {
  /// Chordal compares with certified optima and converges from the furthest; take RotationVector when the information
  /// matrices are real covariances with directions in them.
  Objective objective = Objective::Chordal;
  /// AsGiven for a map that grows; LowestCost or Chordal for a graph whose poses may be far off.
  Initialization initialization = Initialization::AsGiven;
  /// YawAndPosition where an inertial host has levelled the poses given, with the world's z axis up.
  Freedom freedom = Freedom::Full;
  /// None where all edges are trusted. Huber against heavy tails, Cauchy or Geman-McClure when some loops may be false.
  RobustLoss robust_loss = RobustLoss::None;
  /// The scale of the loss: the probability that a right edge's chi-square stays inside the parabola. Lower distrusts more.
  double robust_probability = 0.99;
  /// Which edges get the loss; the others hold sessions together. Odometry judges the loops, so it stays quadratic by default.
  std::vector<EdgeKind> robust_kinds = {EdgeKind::Loop};
  /// More for graphs that start far from their optimum; fewer to bound the time.
  int max_iterations = 200;
  /// Stop when what the cost will still fall by, as the last iterations show, is less than this part of it. Larger for a quick
  /// preview.
  double cost_tolerance = 1e-8;
  /// Told after each iteration: done of max_iterations.
  Progress progress = {};
  /// Asked after each iteration; true stops with the best poses so far.
  std::function<bool()> cancelled = {};
};

/// What an edge contributed at the end.
struct EdgeResult {
  double chi2 = 0.0;    ///< Squared whitened error, before the robust loss.
  double weight = 1.0;  ///< Robust weight in [0, 1]: 1 is believed fully.
};

/// What optimize() did.
struct OptimizeReport {
  /// Sum over edges of rho(chi2), and over priors of chi2, at the given poses, without the factor 1/2 that some solvers print.
  double initial_cost = 0.0;
  double final_cost = 0.0;  ///< As `initial_cost`, at the returned poses.
  /// Where it started: never LowestCost, but what that chose.
  Initialization start = Initialization::AsGiven;
  int iterations = 0;
  Termination termination = Termination::NothingToDo;
  std::vector<EdgeResult> edges;   ///< One per edge, in the graph's order.
  std::vector<EdgeResult> priors;  ///< One per prior, in the graph's order.
  /// Positions of the vertices that were held: those `fixed`, and the first of each connected component without one and without
  /// priors.
  std::vector<std::size_t> anchors;
  std::size_t num_components = 0;  ///< Parts of the graph with no edge between them; each keeps its own place.
  /// Components in which no edge knows a distance: their size is arbitrary and stays near what it was.
  std::size_t num_components_without_scale = 0;
  /// Edges whose information was not positive semi-definite and was replaced by the nearest matrix that is.
  std::size_t num_mended_information = 0;

  /// One line: cost, iterations, how it ended.
  std::string brief() const;
  /// Several lines: also components, anchors, mended matrices and the edges that fit worst.
  std::string full() const;
};

/// Moves the vertices to where the edges agree best, in place. The same input gives the same bytes. Throws InputError for an
/// edge whose ends are not two vertices of the graph, for numbers that are not finite, and for a planar edge without scale.
OptimizeReport optimize(PoseGraph& graph, const OptimizeOptions& options = {});

/// The cost of the graph as it stands: optimize()'s `initial_cost`, without moving anything.
double evaluate_cost(const PoseGraph& graph, const OptimizeOptions& options = {});

/// Error and robust weight of every edge of the graph as it stands, in its order.
std::vector<EdgeResult> evaluate_edges(const PoseGraph& graph, const OptimizeOptions& options = {});

/// "converged", "stopped at the maximum number of iterations", ...
std::string_view in_words(Termination termination);

/// "poses as given", "chordal relaxation", ...
std::string_view in_words(Initialization initialization);

}  // namespace fabloop
