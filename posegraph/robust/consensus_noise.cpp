// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/consensus_noise.h"

#include <algorithm>

#include "posegraph/robust/loop_clusters.h"
#include "posegraph/robust/noise_factors.h"
#include "posegraph/robust/sure_path.h"
#include "posegraph/robust/weighted_solve.h"

namespace fabloop {
namespace {

/// Of variances: errors twice those of the cluster.
constexpr double kVarianceMargin = 4.0;

constexpr double kRoughTolerance = 1e-4;

}  // namespace

std::optional<double> consensus_rotation_factor(const PoseGraph& graph, const LoopConsistency& loops,
                                                const std::vector<EdgeKind>& doubted, const std::vector<double>& sure_weights,
                                                const std::vector<bool>& is_doubted, const OptimizeOptions& optimize) {
  const SurePaths paths(graph, doubted);
  for (std::vector<std::size_t>& cluster : cluster_loops(loops)) {
    std::erase_if(cluster, [&](std::size_t k) { return !is_doubted[loops.edges()[k]]; });
    if (cluster.size() < 2) continue;
    if (!is_agreed_by(graph, loops, paths, cluster)) continue;
    EdgeWeights edges{sure_weights, std::vector<bool>(graph.edges.size(), false)};
    for (const std::size_t k : cluster) edges.weights[loops.edges()[k]] = 1.0;
    OptimizeOptions rough = optimize;
    rough.initialization = relaxation_of(optimize);
    rough.robust_loss = RobustLoss::None;
    rough.cost_tolerance = std::max(rough.cost_tolerance, kRoughTolerance);
    PoseGraph closed = graph;
    solve_weighted(closed, edges, rough);
    const NoiseFactors shown = estimate_noise(closed, edges.weights, optimize.objective, NoiseMean::OfMedianStretch);
    return std::min(1.0, kVarianceMargin * shown.rotation);
  }
  return std::nullopt;
}

}  // namespace fabloop
