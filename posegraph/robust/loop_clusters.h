// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/pose_graph.h"
#include "posegraph/robust/loop_consistency.h"
#include "posegraph/robust/sure_path.h"

namespace fabloop {

/// What cluster_loops() and loops_worth_a_try() may be told.
struct LoopClusterOptions {
  /// Loops are neighbours when so few odometry steps lie between their starts and between their ends, added. More joins loops
  /// that are further apart, over which odometry says less.
  std::size_t max_steps = 20;
  /// Neighbours that a loop is compared with, nearest first. More costs time where loops are dense.
  std::size_t max_neighbours = 10;
};

/// Loops that hang together: neighbours along the odometry that are consistent with each other. Largest first, then by first
/// member; members ascending. A loop without such a neighbour is a cluster of its own. (Clusters in time: Latif et al.,
/// Robust loop closing over time for pose graph SLAM, IJRR 2013.)
std::vector<std::vector<std::size_t>> cluster_loops(const LoopConsistency& loops, const LoopClusterOptions& options = {});

/// How far a cluster is from the surest way between its ends, in thresholds (LoopConsistency::contradiction()): the median of a
/// few members. Zero where no way leads, since nothing speaks against them.
double contradiction(const PoseGraph& graph, const LoopConsistency& loops, const SurePaths& paths,
                     const std::vector<std::size_t>& cluster);

/// Whether most of a few members of a cluster agree with the surest way between their ends.
bool is_agreed_by(const PoseGraph& graph, const LoopConsistency& loops, const SurePaths& paths,
                  const std::vector<std::size_t>& cluster);

/// Which loops to begin with, one entry a loop.
struct LoopTrial {
  std::vector<bool> is_tried;     ///< What is left out may still be right.
  std::vector<bool> is_foremost;  ///< Those of them to begin with: the largest clusters, which hold half of them.
};

/// Clusters of two and more are taken in, the largest first, as far as the surest way through odometry and the loops taken in
/// before does not contradict them.
LoopTrial choose_trial(const PoseGraph& graph, const LoopConsistency& loops, const std::vector<EdgeKind>& doubted,
                       const LoopClusterOptions& options = {});

}  // namespace fabloop
