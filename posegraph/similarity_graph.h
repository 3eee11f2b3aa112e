// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "frontend/geometry/similarity.h"
#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"

namespace fabloop {

/// Translation, rotation, logarithm of the scale: the order of EDGE_SE3:QUAT with one row more.
using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// A view, or a piece of a map, in units of its own.
struct SimilarityVertex {
  std::int64_t id = 0;  ///< As of Vertex.
  Similarity world_from_frame;
  bool fixed = false;  ///< optimize() leaves it as it is, its scale too.
};

/// A measured similarity i_from_j with i = `from`, j = `to`. Its scale is how many units of i one unit of j is: 1 between views
/// of one monocular stretch, and what the structure seen from both says where a loop joins stretches whose scale has drifted
/// apart.
struct SimilarityEdge {
  std::size_t from = 0;  ///< Position in `SimilarityGraph::vertices`, not an id.
  std::size_t to = 0;    ///< As `from`.
  Similarity from_from_to;
  /// Inverse covariance of the error in the frame and the units of `to` (i_from_j_true = i_from_j * error): translation
  /// before rotation [1/rad^2] before the logarithm of the scale. A row of zeros says nothing of its part.
  Matrix7d information = Matrix7d::Identity();
  EdgeKind kind = EdgeKind::Odometry;
};

/// A pose graph in which scale is sought too: seven degrees of freedom a vertex, for monocular maps whose scale drifts, and for
/// maps of unknown relative scale. Plain data.
struct SimilarityGraph {
  std::vector<SimilarityVertex> vertices;
  std::vector<SimilarityEdge> edges;
};

/// Throws InputError naming the vertex or edge that is broken: ends that are not two vertices of the graph, numbers that are not
/// finite, scales that are not positive.
void check(const SimilarityGraph& graph);

/// A rigid graph as a graph of similarities of scale 1. Each edge says that its ends have one scale up to a relative error of
/// `sigma_of_scale`: how much a monocular step may drift. Throws InputError for planar graphs, priors, edges without scale, and
/// for an error that is not positive.
SimilarityGraph similarity_graph_from(const PoseGraph& graph, double sigma_of_scale);

/// Sets every vertex but the anchors (the fixed ones, and the first of each component without) from all edges at once: logarithms
/// of scales by linear least squares, then rotations and translations as initialize_chordal() of pose graphs, with each edge
/// as long as its scale says. Exact for edges that agree. Throws what check() throws.
void initialize_chordal(SimilarityGraph& graph);

/// Sets every vertex by chaining edges breadth-first from the fixed vertices, in a component without one from its first.
void chain_along_edges(SimilarityGraph& graph);

/// Moves the vertices to where the edges agree best, in place (Strasdat, Montiel & Davison, RSS 2010; the error is in this
/// folder's README). Objectives, starts (but Sessions), losses and bounds are those of pose graphs, with one degree of freedom
/// more. Anchors as in initialize_chordal(). The same input gives the same bytes. Throws what check() throws, and what optimize()
/// does for options.
OptimizeReport optimize(SimilarityGraph& graph, const OptimizeOptions& options = {});

/// The cost of the graph as it stands: optimize()'s `initial_cost`, without moving anything.
double evaluate_cost(const SimilarityGraph& graph, const OptimizeOptions& options = {});

}  // namespace fabloop
