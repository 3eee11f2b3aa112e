// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/graduated_back_ends.h"

#include <algorithm>
#include <utility>

#include "posegraph/robust/choice_refinement.h"
#include "posegraph/robust/consensus_noise.h"
#include "posegraph/robust/graduated.h"
#include "posegraph/robust/loop_clusters.h"
#include "posegraph/robust/loop_consistency.h"
#include "posegraph/robust/noise_factors.h"

namespace fabloop {
namespace {

/// Of the last solve of a graduation that is refined.
constexpr double kToleranceBeforeRefinement = 1e-4;

/// Chooses the loops to begin with. Truncated graduation, which knows the noise in the end, begins with that of the largest
/// consensus: `graph` then has this noise, and the problem its thresholds.
void begin_with_clusters(PoseGraph& graph, GraduatedProblem& problem, const LoopRoles& roles, const RobustOptions& options) {
  double noise_scale = roles.noise_scale;
  if (options.back_end == BackEnd::GncTruncated && options.noise == NoiseScale::Observed) {
    const LoopConsistency as_told(graph, options.doubted, options.inlier_probability, noise_scale);
    if (const auto rotation =
            consensus_rotation_factor(graph, as_told, options.doubted, problem.weights, problem.is_doubted, options.optimize)) {
      graph = with_noise(std::move(graph), {noise_scale, std::min(noise_scale, *rotation)});
      problem.c2 = thresholds(graph, options.inlier_probability);
      noise_scale = 1.0;
    }
  }
  const LoopConsistency loops(graph, options.doubted, options.inlier_probability, noise_scale);
  const LoopTrial trial = choose_trial(graph, loops, options.doubted);
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const std::size_t e = loops.edges()[k];
    problem.is_candidate[e] = trial.is_tried[k] && roles.is_doubted[e];
    if (trial.is_foremost[k] && roles.is_doubted[e]) problem.weights[e] = 1.0;
  }
}

GraduatedProblem problem_of(const LoopRoles& roles, const RobustOptions& options) {
  GraduatedProblem problem;
  problem.c2 = roles.c2;
  problem.is_doubted = roles.is_doubted;
  problem.surrogate = options.back_end == BackEnd::GncTruncated ? Surrogate::TruncatedLeastSquares : Surrogate::GemanMcClure;
  problem.factor = options.gnc_factor;
  problem.weights = weights_of(roles, 0.0).weights;
  problem.is_candidate.assign(roles.is_doubted.size(), false);
  for (std::size_t e = 0; e < roles.is_doubted.size(); ++e) {
    if (roles.is_doubted[e] && !options.warm_weights.empty()) problem.weights[e] = options.warm_weights[e];
  }
  return problem;
}

}  // namespace

BackEndSolution solve_graduated(PoseGraph& graph, const LoopRoles& roles, const RobustOptions& options) {
  GraduatedProblem problem = problem_of(roles, options);
  PoseGraph honest = graph;
  if (options.warm_weights.empty()) begin_with_clusters(honest, problem, roles, options);
  const bool is_truncated = options.back_end == BackEnd::GncTruncated;
  PoseGraph judged = is_truncated ? judged_honestly(std::move(honest), options.optimize.objective) : std::move(honest);
  GraduatedResult result = graduate(judged, problem, options.optimize);
  graph.vertices = std::move(judged.vertices);
  return {std::move(result.last_solve), std::move(result.weights), result.num_solves};
}

BackEndSolution solve_truncated(PoseGraph& graph, const LoopRoles& roles, const RobustOptions& options) {
  // What follows begins with a solve of its own.
  RobustOptions rough = options;
  rough.optimize.cost_tolerance = std::max(options.optimize.cost_tolerance, kToleranceBeforeRefinement);
  BackEndSolution graduated = solve_graduated(graph, roles, rough);
  RefinedChoice refined = refine_choice(graph, std::move(graduated.weights), roles.is_doubted, options);
  const EdgeWeights edges{refined.weights, std::vector<bool>(graph.edges.size(), false)};
  BackEndSolution solution{solve_weighted(graph, edges, options.optimize), std::move(refined.weights)};
  solution.num_solves = graduated.num_solves + refined.num_solves + 1;
  solution.noise = refined.noise;
  return solution;
}

}  // namespace fabloop
