// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/choice_refinement.h"

#include <algorithm>
#include <utility>

#include "posegraph/robust/cluster_exchange.h"
#include "posegraph/robust/loop_consistency.h"
#include "posegraph/robust/loop_odds.h"
#include "posegraph/robust/weighted_solve.h"

namespace fabloop {
namespace {

/// The second time the noise is that of a choice that the first guess at it did not make.
constexpr int kMaxRounds = 2;

/// No quantile is told from infinity further out.
constexpr double kLeastProbability = 1e-12;

double probability_lost(const RobustOptions& options) {
  const double p_outside = 1.0 - options.inlier_probability;
  return std::max(kLeastProbability, p_outside * p_outside);
}

/// Share of the doubted edges that are left out, never quite none nor all (Laplace's rule of succession).
double share_left_out(const std::vector<double>& weights, const std::vector<bool>& is_doubted) {
  double num_doubted = 2.0;
  double num_left_out = 1.0;
  for (std::size_t e = 0; e < weights.size(); ++e) {
    num_doubted += is_doubted[e];
    num_left_out += is_doubted[e] && weights[e] == 0.0;
  }
  return num_left_out / num_doubted;
}

/// The last word, once clusters have found their place: a loop stays out only where it is likelier false than right.
void reconsider(PoseGraph& graph, RefinedChoice& refined, const std::vector<bool>& is_doubted, const RobustOptions& options) {
  const PoseGraph honest = with_noise(graph, refined.noise);
  const PoseGraph judged = judged_honestly(honest, options.optimize.objective);
  TruncatedProblem problem{thresholds(judged, 1.0 - probability_lost(options)), is_doubted, refined.weights};
  const std::vector<double> even_odds = even_odds_chi2(honest, share_left_out(refined.weights, is_doubted));
  for (std::size_t e = 0; e < even_odds.size(); ++e) problem.c2[e] = std::max(problem.c2[e], even_odds[e]);
  TruncatedChoice choice = settle_wider(judged, problem, options.optimize);
  refined.weights = std::move(choice.weights);
  refined.num_solves += choice.num_solves;
  graph.vertices = std::move(choice.vertices);
}

}  // namespace

RefinedChoice refine_choice(PoseGraph& graph, std::vector<double> weights, const std::vector<bool>& is_doubted,
                            const RobustOptions& options) {
  RefinedChoice refined{std::move(weights), {}, 0};
  const bool is_noise_sought = options.noise == NoiseScale::Observed;
  const auto estimate = [&](NoiseMean mean) {
    if (is_noise_sought) refined.noise = estimate_noise(graph, refined.weights, options.optimize.objective, mean);
  };
  for (int round = 0; round < (is_noise_sought ? kMaxRounds : 1); ++round) {
    estimate(NoiseMean::OfMedianStretch);
    const PoseGraph honest = with_noise(graph, refined.noise);
    PoseGraph judged = judged_honestly(honest, options.optimize.objective);
    const TruncatedProblem problem{thresholds(judged, 1.0 - probability_lost(options)), is_doubted, std::move(refined.weights)};
    const LoopConsistency loops(honest, options.doubted, options.inlier_probability);
    ClusterExchangeOptions exchange_options;
    exchange_options.begins_anew = round == 0;
    ClusterExchange exchange = exchange_clusters(judged, problem, loops, options.doubted, options.optimize, exchange_options);
    refined.weights = std::move(exchange.weights);
    refined.num_solves += exchange.num_solves;
    graph.vertices = std::move(judged.vertices);
  }
  for (int round = 0; round < kMaxRounds; ++round) {
    estimate(NoiseMean::OfAll);
    reconsider(graph, refined, is_doubted, options);
  }
  return refined;
}

}  // namespace fabloop
