// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/pose_graph.h"

namespace fabloop {

/// Which vertices hang together.
struct Components {
  std::vector<std::size_t> of_vertex;  ///< Component of each vertex, numbered in the order of their first vertices.
  std::size_t count = 0;
};

/// Connected components over all edges.
Components connected_components(const PoseGraph& graph);

/// Positions, ascending, of the vertices that an optimisation must hold: those `fixed`, and the first of each component without
/// one, since edges say nothing about where a component is.
std::vector<std::size_t> find_anchors(const PoseGraph& graph, const Components& components);

/// One edge walked, from one of its ends to the other.
struct EdgeStep {
  std::size_t edge = 0;
  std::size_t from = 0;  ///< A vertex reached before, which need not be the edge's `from`.
  std::size_t to = 0;    ///< The vertex reached by it.
};

/// The steps that reach every vertex breadth-first from the fixed vertices, in a component without one from its first vertex.
/// Edges without scale are walked after a vertex's other edges.
std::vector<EdgeStep> breadth_first(const PoseGraph& graph);

/// Sets every vertex by chaining edges breadth-first from the fixed vertices, in a component without one from its first
/// vertex; those keep their poses. Edges without scale are chained with unit length, after a vertex's other edges.
void chain_along_edges(PoseGraph& graph);

}  // namespace fabloop
