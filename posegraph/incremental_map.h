// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"

namespace fabloop {

/// What an IncrementalMap may be told.
struct IncrementalOptions {
  /// Objective, loss and tolerance of every solve; `max_iterations` is that of finish().
  OptimizeOptions optimize = {};
  /// Newest vertices that move when an edge comes that closes no loop. More lets neighbours correct further back and takes
  /// longer.
  std::size_t window = 30;
  /// Maps up to this size move vertex by vertex when a loop comes. Larger ones move in so many pieces, which bounds the time of a
  /// step however long the walk; finish() moves every vertex. More bends more finely and takes longer.
  std::size_t max_pieces = 300;
  /// Iterations over the map in a step, from the step in which a loop came until the map has settled. More settles in fewer
  /// steps, and makes each take longer.
  int whole_map_iterations = 2;
  /// The map has settled when an iteration lowers the cost by less than this part of it.
  double settled_tolerance = 1e-5;
};

/// What a step did.
struct IncrementalStep {
  enum class Kind {
    Chained,   ///< Nothing but odometry came: the new vertex stands where it leads.
    Window,    ///< The newest vertices were moved.
    WholeMap,  ///< All vertices were moved.
    Pieces,    ///< All vertices were moved, in pieces.
  };
  Kind kind = Kind::Chained;
  OptimizeReport report;  ///< Of the solve, if there was one.
};

/// A map that grows vertex by vertex, each step in bounded time: odometry chains, neighbours move a window, and a loop moves the
/// whole map, a few iterations in each step from the poses so far, in pieces where it is long. finish() ends where optimize()
/// would have ended on the whole graph.
class IncrementalMap {
 public:
  /// The first vertex stands where its odometry says, and is held.
  explicit IncrementalMap(const IncrementalOptions& options = {}) : options_(options) {}

  /// Adds the next vertex, joined to the one before by an odometry edge with this information. Returns its position. Throws
  /// InputError for numbers that are not finite.
  std::size_t add_keyframe(std::int64_t id, const Pose& odom_from_body, const Matrix6d& information);

  /// Adds a neighbour or loop edge between vertices that are there. Throws InputError as check() does.
  void add_edge(const Edge& edge);

  /// Takes in what came since the last step.
  IncrementalStep step();

  /// Solves the whole map until it converges.
  OptimizeReport finish();

  /// The map so far.
  const PoseGraph& graph() const { return graph_; }

  /// Whether loops still have something to move.
  bool is_settled() const { return is_settled_; }

  /// What a host puts before its odometry: the newest vertex's pose in the map is map_from_odom() * odom_from_body. The identity
  /// before the first vertex.
  Pose map_from_odom() const;

 private:
  OptimizeReport solve_window();
  IncrementalStep solve_map();

  IncrementalOptions options_;
  PoseGraph graph_;
  Pose odom_from_newest_;
  std::size_t num_edges_taken_in_ = 0;  ///< Edges before this position have been solved for.
  bool is_settled_ = true;
};

}  // namespace fabloop
