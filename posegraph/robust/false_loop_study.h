// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/pose_graph.h"
#include "posegraph/robust/false_loops.h"
#include "posegraph/robust/robust_optimize.h"

namespace fabloop {

/// What a back end made of a graph with false loops.
struct FalseLoopTrial {
  double ate_m = 0.0;  ///< Root mean square of the distances to the truth, after rigid alignment.
  std::size_t num_true = 0, num_true_kept = 0;
  std::size_t num_false = 0, num_false_kept = 0;
  double cpu_s = 0.0;  ///< Of robust_optimize() alone, processor time.
  RobustReport report;

  /// Share of the kept loops that are true; 1 where none is kept.
  double precision() const;
  /// Share of the true loops that are kept; 1 where there is none.
  double recall() const;
};

/// Adds false loops to a graph whose loops count as true, starts from where its odometry leads, and has a back end sort it out.
/// `truth` has a pose for every vertex, in the same order; where nothing better is known, the optimum without false loops.
/// Throws InputError as add_false_loops() and robust_optimize() do, and when the truth has another number of poses.
FalseLoopTrial try_false_loops(PoseGraph graph, const std::vector<Vertex>& truth, const FalseLoopOptions& false_loops,
                               const RobustOptions& options);

/// The vertices where the back end "none" leaves the graph as it is: a truth for graphs that ship none.
std::vector<Vertex> optimum_without_false_loops(PoseGraph graph, const OptimizeOptions& options = {});

}  // namespace fabloop
