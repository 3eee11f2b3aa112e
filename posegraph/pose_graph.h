// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// Translation before rotation, as in .g2o files. (GTSAM is rotation-first: swap the blocks at that border.)
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A view whose pose is sought.
struct Vertex {
  std::int64_t id = 0;  ///< The user's name for it: a frame's position, an id in a file. Unique in a graph.
  Pose world_from_frame;
  bool fixed = false;  ///< optimize() leaves the pose as it is: an anchor.
};

/// Where an edge comes from. It decides who is trusted: by default only loops get a robust loss.
enum class EdgeKind {
  Odometry,   ///< Consecutive frames.
  Neighbour,  ///< Nearby frames seen in one pass, verified by their images.
  Loop,       ///< A place seen again.
};

/// A measured relative pose i_from_j with i = `from`, j = `to`.
struct Edge {
  std::size_t from = 0;  ///< Position in `PoseGraph::vertices`, not an id.
  std::size_t to = 0;    ///< As `from`.
  Pose from_from_to;     ///< The pose of `to` in `from`. Without scale the translation is a unit direction.
  /// Inverse covariance of the error in the frame of `to` (i_from_j_true = i_from_j * error), translation [1/m^2] before
  /// rotation [1/rad^2], as g2o has it. Without scale the translation block weighs the error of the unit direction
  /// [1/rad^2]; its component along the direction is not used.
  Matrix6d information = Matrix6d::Identity();
  EdgeKind kind = EdgeKind::Odometry;
  bool has_scale = true;  ///< False: rotation and direction of translation are known, the distance is not.
};

/// What is known about one vertex from outside.
enum class PriorKind {
  Pose,      ///< All of it.
  Position,  ///< From GPS; with information along z only, an altitude.
  Attitude,  ///< Which way is up, from an accelerometer: roll and pitch, not yaw. The world's z axis points up.
};

/// A measured pose of one vertex in the world, or the part of it that `kind` names.
struct VertexPrior {
  std::size_t vertex = 0;  ///< Position in `PoseGraph::vertices`, not an id.
  PriorKind kind = PriorKind::Pose;
  Pose world_from_frame;
  /// Inverse covariance, translation [1/m^2] before rotation [1/rad^2]: of a pose in the frame of the vertex as for edges; of a
  /// position (the first three) along the axes of the world; of an attitude (the last three) about the axes of the vertex.
  Matrix6d information = Matrix6d::Identity();
};

/// Where all views are, and what says so. Plain data: optimize() bends it, read_g2o() and write_g2o() keep it.
struct PoseGraph {
  std::vector<Vertex> vertices;
  std::vector<Edge> edges;
  /// 3, or 2 for planar graphs: then z, roll and pitch are zero and only entries (x, y, yaw) = (0, 1, 5) of the
  /// information are used.
  int dimension = 3;
  std::vector<VertexPrior> priors = {};
};

/// Throws InputError naming the vertex, edge or prior that is broken: an edge whose ends are not two vertices of the graph,
/// numbers that are not finite, an edge without scale that has no direction either or is planar, a prior of no vertex, a planar
/// attitude.
void check(const PoseGraph& graph);

}  // namespace fabloop
