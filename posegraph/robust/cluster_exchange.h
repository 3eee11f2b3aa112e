// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"
#include "posegraph/robust/loop_consistency.h"
#include "posegraph/robust/truncated_choice.h"

namespace fabloop {

/// What exchange_clusters() may be told.
struct ClusterExchangeOptions {
  /// Clusters tried one by one in each direction before a round is given up. More finds more and takes longer, a solve each.
  std::size_t max_failures = 3;
  /// Rounds of letting in and leaving out.
  std::size_t max_rounds = 10;
  /// Also tries the loops that one would begin with under the noise as it is known by now (choose_trial()): one settling, which a
  /// choice that was begun so need not repeat.
  bool begins_anew = true;
};

/// What exchange_clusters() found.
struct ClusterExchange {
  std::vector<double> weights;  ///< 0 or 1, one an edge.
  double cost = 0.0;            ///< The truncated cost at the poses returned.
  std::size_t num_solves = 0;
  std::size_t num_let_in = 0, num_left_out = 0;  ///< Exchanges that were kept; one may be of several clusters.
};

/// Local search of the truncated cost over clusters of loops. Alternating choice and solve cannot bring back a group of loops
/// that lies far off, nor get rid of one that the map has bent to. So groups of loops that are left out, agree among
/// themselves, and are not contradicted by the surest way through odometry and the loops kept, are let in on trial; what is kept
/// of the groups that this way, without themselves, contradicts most is left out on trial; and what lowers the truncated cost
/// stays. `loops` are those of the graph.
/// The cost never rises.
ClusterExchange exchange_clusters(PoseGraph& graph, const TruncatedProblem& problem, const LoopConsistency& loops,
                                  const std::vector<EdgeKind>& doubted, const OptimizeOptions& optimize,
                                  const ClusterExchangeOptions& options = {});

}  // namespace fabloop
