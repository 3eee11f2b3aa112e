// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/choice_refinement.h"

#include <algorithm>
#include <utility>

#include "posegraph/robust/cluster_exchange.h"
#include "posegraph/robust/loop_consistency.h"
#include "posegraph/robust/weighted_solve.h"

namespace fabloop {
namespace {

/// The second time the noise is that of a choice that the first guess at it did not make.
constexpr int kMaxRounds = 2;

/// No quantile is told from infinity further out.
constexpr double kLeastProbability = 1e-12;

}  // namespace

RefinedChoice refine_choice(PoseGraph& graph, std::vector<double> weights, const std::vector<bool>& is_doubted,
                            const RobustOptions& options) {
  RefinedChoice refined{std::move(weights), {}, 0};
  const NoiseFactors of_objective = factors_of_objective(options.optimize.objective, graph.dimension);
  const double p_outside = 1.0 - options.inlier_probability;
  const double p_lost = std::max(kLeastProbability, p_outside * p_outside);
  for (int round = 0; round < (options.noise == NoiseScale::Observed ? kMaxRounds : 1); ++round) {
    if (options.noise == NoiseScale::Observed) {
      refined.noise = estimate_noise(graph, refined.weights, options.optimize.objective);
    }
    const PoseGraph honest = with_noise(graph, refined.noise);
    PoseGraph judged = with_noise(honest, of_objective);
    const TruncatedProblem problem{thresholds(judged, 1.0 - p_lost), is_doubted, std::move(refined.weights)};
    const LoopConsistency loops(honest, options.doubted, options.inlier_probability);
    ClusterExchange exchange = exchange_clusters(judged, problem, loops, options.doubted, options.optimize);
    refined.weights = std::move(exchange.weights);
    refined.num_solves += exchange.num_solves;
    graph.vertices = std::move(judged.vertices);
  }
  return refined;
}

}  // namespace fabloop
