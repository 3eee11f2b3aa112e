// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"
#include "posegraph/robust/loop_consistency.h"
#include "posegraph/robust/noise_factors.h"

namespace fabloop {

/// The noise by which all loops may be judged at first: what the largest cluster that odometry does not contradict shows together
/// with the trusted edges (estimate_noise()), solved for. Chance and look-alike places seldom make the largest cluster, and where
/// information promises far less than it holds, every other group of loops fits as well. Errors twice as large are allowed,
/// since a cluster sees a part of the map; more noise than told is left to where more loops have their say. `loops` are those of
/// the graph. None where no two loops agree.
std::optional<NoiseFactors> consensus_noise(const PoseGraph& graph, const LoopConsistency& loops,
                                            const std::vector<EdgeKind>& doubted, const OptimizeOptions& optimize);

}  // namespace fabloop
