// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/pose_graph.h"

namespace fabloop {

/// A few vertices of a long chain that stand for the rest: between two of them the chain moves as one piece.
struct MapSkeleton {
  /// Its vertices are those of `kept`. Its edges: odometry composed between them, and of the other edges that lead from piece to
  /// piece the newest of each two, carried to where the pieces begin.
  PoseGraph graph;
  std::vector<std::size_t> kept;  ///< Positions in the whole graph, ascending, from 0.
};

/// At most about `max_vertices` of the graph, evenly spread, among them the first and the newest. The graph's vertices must be
/// one chain: an odometry edge between each and the next, with the edges of later vertices after those of earlier ones.
MapSkeleton make_skeleton(const PoseGraph& graph, std::size_t max_vertices);

/// Moves the pieces after the skeleton's vertices were moved: each vertex with both ends of its piece, more with the nearer.
void follow_skeleton(const MapSkeleton& skeleton, PoseGraph& graph);

}  // namespace fabloop
