// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posegraph/pose_graph.h"

namespace fabloop {

/// Where optimize() starts. Pose graphs have local minima, and the start decides which one is found.
enum class Initialization {
  AsGiven,       ///< The poses as they are: right when they come from a map that was solved before.
  SpanningTree,  ///< chain_along_edges(): the fewest edges from the anchors. Cheap; errors add up along the branches.
  Chordal,       ///< initialize_chordal(): all edges at once. Trusts every edge, so false loops spoil it.
  /// Several trajectories that only loops join: chain_sessions(), then align_sessions(). A false loop among several does no harm.
  Sessions,
  /// Whichever of these has the lowest cost, robust losses included, before anything is moved.
  LowestCost,
};

/// Sets every vertex but the anchors (find_anchors()) from all edges at once, whatever the poses were, by two linear least
/// squares: first kappa |R_j - R_i R_ij|_F^2 over matrices R that need not be rotations, each then replaced by the nearest
/// rotation; then tau |t_j - t_i - R_i t_ij|^2 over translations. Exact for edges that agree, near the global optimum for noise
/// as in maps. Edges without scale enter the second part as long as their ends are apart now, with next to no weight.
/// Source: Martinec & Pajdla, CVPR 2007; Carlone et al., ICRA 2015, section III-B. Throws what check() throws.
void initialize_chordal(PoseGraph& graph);

/// Moves each component without a fixed vertex, as one rigid body, to where its priors want it: onto its first pose prior, or
/// with least squares onto its position priors (turned too where there are three or more; Umeyama 1991).
void move_to_priors(PoseGraph& graph);

}  // namespace fabloop
