// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/connectivity.h"
#include "posegraph/pose_graph.h"

namespace fabloop {

/// What align_sessions() may be told.
struct SessionAlignmentOptions {
  /// Kinds of edges that may be false. The others hold a session together.
  std::vector<EdgeKind> doubted = {EdgeKind::Loop};
  /// Two right loops agree with this probability, as their information and that of the odometry between them tell.
  double inlier_probability = 0.99;
  /// So many loops of two sessions, evenly spread, propose where one lies in the other; all of them vote. More costs time where
  /// sessions are joined by thousands.
  std::size_t max_proposals = 200;
};

/// One session placed by its loops with another.
struct SessionJoin {
  std::size_t session = 0;       ///< The one moved; numbered in the order of first vertices.
  std::size_t placed_in = 0;     ///< The one that had its place.
  std::size_t edge = 0;          ///< The loop whose alignment was taken.
  std::size_t num_agreeing = 0;  ///< Loops of the two that agree with it, itself included.
  std::size_t num_loops = 0;     ///< Loops of the two.
};

/// What align_sessions() did.
struct SessionAlignment {
  Components sessions;             ///< Which vertices trusted edges hold together.
  std::vector<SessionJoin> joins;  ///< In the order in which sessions found their place.
};

/// How many sessions there are: parts of the graph that edges of kinds not `doubted` hold together.
std::size_t num_sessions(const PoseGraph& graph, const std::vector<EdgeKind>& doubted);

/// Sets the vertices of each session by chaining those edges from its first or its fixed vertices,
/// so that no false loop has bent it. Sessions keep the relative place of these vertices.
void chain_sessions(PoseGraph& graph, const std::vector<EdgeKind>& doubted);

/// Places several trajectories of unknown relative alignment, joined by loops of which some may be false: each session is moved
/// as one rigid body onto those placed before. Every loop proposes an alignment, and the
/// one that most loops of the same two sessions agree with (LoopConsistency, so that distance along the odometry counts) is
/// taken, the strongest pair of sessions first. Sessions with a fixed vertex keep their place, or the first one where there
/// is none. Loops without scale do not say how far: they have no part in it. A session without loops stays where it is.
SessionAlignment align_sessions(PoseGraph& graph, const SessionAlignmentOptions& options = {});

}  // namespace fabloop
