// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/pose_graph.h"

namespace fabloop {

/// Covariance of an edge's error, in the frame of `to`. Planar graphs have zeros for z, roll and pitch. Where the information
/// says nothing (an eigenvalue of zero, rounding apart), the covariance is as large as rounding lets it be.
Matrix6d edge_covariance(const Edge& edge, int dimension);

/// What odometry alone says about any two vertices: poses and covariances accumulated along a spanning tree of trusted edges, so
/// that a question costs the logarithm of the number of vertices.
class OdometryTree {
 public:
  /// The edges whose kind is not in `doubted` are trusted. Of them the tree takes those with scale, breadth-first.
  OdometryTree(const PoseGraph& graph, const std::vector<EdgeKind>& doubted);

  /// Whether trusted edges lead from one to the other.
  bool joins(std::size_t i, std::size_t j) const { return root_[i] == root_[j]; }

  /// Number of edges between the two; they must be joined.
  std::size_t num_steps(std::size_t i, std::size_t j) const;

  /// Number of edges from the tree's first vertex.
  std::size_t depth(std::size_t v) const { return depth_[v]; }

  /// Pose in the frame of the tree's first vertex.
  const Pose& root_from_vertex(std::size_t v) const { return root_from_vertex_[v]; }

  /// Covariance of the way from i to j in the frame of the tree's first vertex: i_from_j is off by
  /// root_from_i^-1 * Exp(e) * root_from_i * i_from_j. They must be joined.
  Matrix6d covariance_in_root(std::size_t i, std::size_t j) const;

 private:
  std::size_t common_ancestor(std::size_t i, std::size_t j) const;

  std::vector<std::size_t> root_, depth_;
  std::vector<std::vector<std::size_t>> ancestors_;  ///< [k][v]: the ancestor 2^k steps up, or the root.
  std::vector<Pose> root_from_vertex_;
  std::vector<Matrix6d> covariance_in_root_;
};

}  // namespace fabloop
