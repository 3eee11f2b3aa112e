// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"
#include "posegraph/robust/loop_consistency.h"

namespace fabloop {

/// By what the variances of rotations that information matrices tell are to be multiplied to judge all loops at first, at most
/// 1: four times what the largest cluster that odometry does not contradict shows together with the trusted edges
/// (estimate_noise()), solved for. It is rotations that make odometry drift, and where they are said to err far more than they
/// do, a false group could be right wherever it is. Chance and look-alike places seldom make the largest cluster. Errors twice
/// as large are allowed, since a cluster sees a part of the map. `loops` are those of the graph; `sure_weights` (one an edge) is
/// 1 for edges that are trusted or accepted by a person and 0 for all others, of which only those that are doubted (one an edge)
/// form clusters. None where no two of them agree.
std::optional<double> consensus_rotation_factor(const PoseGraph& graph, const LoopConsistency& loops,
                                                const std::vector<EdgeKind>& doubted, const std::vector<double>& sure_weights,
                                                const std::vector<bool>& is_doubted, const OptimizeOptions& optimize);

}  // namespace fabloop
