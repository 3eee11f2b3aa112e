// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/robust_optimize.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <string>

#include "frontend/error.h"
#include "frontend/names.h"
#include "posegraph/robust/choice_refinement.h"
#include "posegraph/robust/consensus_noise.h"
#include "posegraph/robust/consistent_loops.h"
#include "posegraph/robust/graduated.h"
#include "posegraph/robust/loop_clusters.h"
#include "posegraph/robust/loop_consistency.h"
#include "posegraph/robust/session_alignment.h"
#include "posegraph/robust/switchable.h"
#include "posegraph/robust/weighted_solve.h"

namespace fabloop {
namespace {

constexpr std::array<Named<EdgeVerdict>, 5> kVerdicts{{{EdgeVerdict::Trusted, "Trusted"},
                                                       {EdgeVerdict::Kept, "Kept"},
                                                       {EdgeVerdict::Rejected, "Rejected"},
                                                       {EdgeVerdict::ForcedAccept, "ForcedAccept"},
                                                       {EdgeVerdict::ForcedReject, "ForcedReject"}}};

/// Back ends that choose leave weights of 0 and 1.
constexpr double kKeptWeight = 0.5;

/// Of the last solve of a graduation that is refined.
constexpr double kToleranceBeforeRefinement = 1e-4;

/// What each edge is before anything is solved.
struct Roles {
  std::vector<EdgeVerdict> forced;  ///< Trusted, ForcedAccept or ForcedReject; Kept where it is to be decided.
  std::vector<bool> is_doubted;     ///< To be decided.
  std::vector<double> c2;           ///< Squared threshold.
  double noise_scale = 1.0;
};

void check(const PoseGraph& graph, const RobustOptions& options) {
  check(graph);
  if (!(options.inlier_probability > 0.0 && options.inlier_probability < 1.0)) {
    throw InputError("robust back end: the inlier probability must be between 0 and 1, both excluded");
  }
  if (!(options.gnc_factor > 1.0)) throw InputError("robust back end: the factor of graduated non-convexity must be above 1");
  if (options.back_end == BackEnd::SwitchableConstraints && !graph.priors.empty()) {
    throw InputError("robust back end: switchable constraints know no priors, of which the graph has " +
                     std::to_string(graph.priors.size()) + "; take another back end, or a graph without them");
  }
  if (!options.warm_weights.empty() && options.warm_weights.size() != graph.edges.size()) {
    throw InputError("robust back end: there are " + std::to_string(options.warm_weights.size()) +
                     " weights of an earlier solve for " + std::to_string(graph.edges.size()) +
                     " edges; give one for each, 1 for new ones");
  }
}

Roles roles_of(const PoseGraph& graph, const RobustOptions& options) {
  Roles roles;
  if (options.noise == NoiseScale::Observed) {
    roles.noise_scale = observed_noise_scale(LoopConsistency(graph, options.doubted, options.inlier_probability));
  }
  roles.c2 = thresholds(graph, options.inlier_probability);
  for (double& c2 : roles.c2) c2 *= roles.noise_scale;
  for (const Edge& edge : graph.edges) {
    const bool is_doubted = std::find(options.doubted.begin(), options.doubted.end(), edge.kind) != options.doubted.end();
    roles.forced.push_back(is_doubted ? EdgeVerdict::Kept : EdgeVerdict::Trusted);
  }
  const auto force = [&](const std::vector<std::size_t>& edges, EdgeVerdict verdict) {
    for (const std::size_t e : edges) {
      const std::string name = "robust back end: edge " + std::to_string(e) + " (counted from 0) ";
      if (e >= graph.edges.size()) throw InputError(name + "is forced, but is not there");
      if (roles.forced[e] == EdgeVerdict::Trusted) throw InputError(name + "is forced, but is trusted anyway: it is no loop");
      if (roles.forced[e] != EdgeVerdict::Kept && roles.forced[e] != verdict) {
        throw InputError(name + "is both accepted and rejected by force; choose one");
      }
      roles.forced[e] = verdict;
    }
  };
  force(options.accept, EdgeVerdict::ForcedAccept);
  force(options.reject, EdgeVerdict::ForcedReject);
  for (const EdgeVerdict verdict : roles.forced) roles.is_doubted.push_back(verdict == EdgeVerdict::Kept);
  return roles;
}

/// The weights with which every loop to be decided has `weight`.
EdgeWeights weights_of(const Roles& roles, double weight) {
  EdgeWeights edges;
  edges.has_loss.assign(roles.forced.size(), false);
  for (std::size_t e = 0; e < roles.forced.size(); ++e) {
    edges.weights.push_back(roles.is_doubted[e] ? weight : roles.forced[e] == EdgeVerdict::ForcedReject ? 0.0 : 1.0);
  }
  return edges;
}

/// Poses chained along the trusted edges, several sessions placed by the loops that agree, then settled between the trusted edges
/// and the loops accepted by force.
void go_to_odometry(PoseGraph& graph, const Roles& roles, const RobustOptions& options) {
  chain_sessions(graph, options.doubted);
  align_sessions(graph, {options.doubted, options.inlier_probability});
  solve_weighted(graph, weights_of(roles, 0.0), options.optimize);
}

RobustLoss loss_of(BackEnd back_end) {
  switch (back_end) {
    case BackEnd::Huber:
      return RobustLoss::Huber;
    case BackEnd::Cauchy:
      return RobustLoss::Cauchy;
    case BackEnd::GemanMcClure:
      return RobustLoss::GemanMcClure;
    case BackEnd::DynamicCovarianceScaling:
      return RobustLoss::DynamicCovarianceScaling;
    default:
      return RobustLoss::None;
  }
}

/// What a back end found, before verdicts.
struct Solution {
  OptimizeReport last_solve;
  std::vector<double> weights;
  std::size_t num_solves = 1;
  bool is_proven = true;
  NoiseFactors noise = {};
};

Solution solve_with_loss(PoseGraph& graph, const Roles& roles, const RobustOptions& options) {
  EdgeWeights edges = weights_of(roles, 1.0);
  edges.has_loss = roles.is_doubted;
  OptimizeOptions with_loss = options.optimize;
  with_loss.robust_loss = loss_of(options.back_end);
  with_loss.robust_probability = options.inlier_probability;
  Solution solution{solve_weighted(graph, edges, with_loss, roles.noise_scale), edges.weights};
  const std::vector<double> chi2 = evaluate_chi2(graph, options.optimize.objective);
  for (std::size_t e = 0; e < chi2.size(); ++e) {
    if (roles.is_doubted[e]) solution.weights[e] = robust_weight(with_loss.robust_loss, chi2[e], roles.c2[e]);
  }
  return solution;
}

/// Chooses the loops to begin with. Truncated graduation, which knows the noise in the end, begins with that of the largest
/// consensus: `graph` then has this noise, and the problem its thresholds.
void begin_with_clusters(PoseGraph& graph, GraduatedProblem& problem, const Roles& roles, const RobustOptions& options) {
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

Solution solve_graduated(PoseGraph& graph, const Roles& roles, const RobustOptions& options) {
  GraduatedProblem problem;
  problem.c2 = roles.c2;
  problem.is_doubted = roles.is_doubted;
  problem.surrogate = options.back_end == BackEnd::GncTruncated ? Surrogate::TruncatedLeastSquares : Surrogate::GemanMcClure;
  problem.factor = options.gnc_factor;
  problem.weights = weights_of(roles, 0.0).weights;
  problem.is_candidate.assign(graph.edges.size(), false);
  PoseGraph honest = graph;
  if (options.warm_weights.empty()) begin_with_clusters(honest, problem, roles, options);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    if (roles.is_doubted[e] && !options.warm_weights.empty()) problem.weights[e] = options.warm_weights[e];
  }
  if (options.back_end != BackEnd::GncTruncated) {
    GraduatedResult result = graduate(graph, problem, options.optimize);
    return {std::move(result.last_solve), std::move(result.weights), result.num_solves};
  }
  PoseGraph judged = with_noise(honest, factors_of_objective(options.optimize.objective, graph.dimension));
  // What follows begins with a solve of its own.
  OptimizeOptions rough = options.optimize;
  rough.cost_tolerance = std::max(rough.cost_tolerance, kToleranceBeforeRefinement);
  GraduatedResult result = graduate(judged, problem, rough);
  graph.vertices = std::move(judged.vertices);
  RefinedChoice refined = refine_choice(graph, std::move(result.weights), roles.is_doubted, options);
  const EdgeWeights edges{refined.weights, std::vector<bool>(graph.edges.size(), false)};
  Solution solution{solve_weighted(graph, edges, options.optimize), std::move(refined.weights)};
  solution.num_solves = result.num_solves + refined.num_solves + 1;
  solution.noise = refined.noise;
  return solution;
}

Solution solve_consistent(PoseGraph& graph, const Roles& roles, const RobustOptions& options) {
  const LoopConsistency loops(graph, options.doubted, options.inlier_probability, roles.noise_scale);
  const ConsistentLoops found = most_consistent_loops(loops, options.max_clique_work);
  EdgeWeights edges = weights_of(roles, 0.0);
  for (const std::size_t loop : found.loops) {
    if (roles.is_doubted[loops.edges()[loop]]) edges.weights[loops.edges()[loop]] = 1.0;
  }
  Solution solution{solve_weighted(graph, edges, options.optimize), edges.weights};
  solution.is_proven = found.is_proven;
  return solution;
}

Solution solve_switchable(PoseGraph& graph, const Roles& roles, const RobustOptions& options) {
  SwitchableProblem problem{weights_of(roles, 1.0).weights, roles.is_doubted, roles.c2};
  SwitchableResult result = solve_with_switches(graph, problem, options.optimize);
  return {std::move(result.solve), std::move(result.weights)};
}

/// Losses never let go of a loop altogether: those beyond the threshold are called rejected.
bool is_rejected(BackEnd back_end, const EdgeDecision& decision, double c2) {
  switch (back_end) {
    case BackEnd::None:
      return false;
    case BackEnd::GncTruncated:
    case BackEnd::PairwiseConsistency:
      return decision.weight < kKeptWeight;
    default:
      return decision.chi2 > c2;
  }
}

Solution solve(PoseGraph& graph, const Roles& roles, const RobustOptions& options) {
  switch (options.back_end) {
    case BackEnd::GncTruncated:
    case BackEnd::GncGemanMcClure:
      return solve_graduated(graph, roles, options);
    case BackEnd::PairwiseConsistency:
      return solve_consistent(graph, roles, options);
    case BackEnd::SwitchableConstraints:
      return solve_switchable(graph, roles, options);
    default:
      return solve_with_loss(graph, roles, options);
  }
}

}  // namespace

std::string_view to_string(EdgeVerdict verdict) { return name_of(kVerdicts, verdict); }

std::vector<double> RobustReport::weights() const {
  std::vector<double> result;
  for (const EdgeDecision& edge : edges) result.push_back(edge.weight);
  return result;
}

std::string RobustReport::brief() const {
  std::ostringstream text;
  text << "loops " << num_kept << " kept, " << num_rejected << " rejected; " << num_solves
       << " solves, the last: " << last_solve.brief();
  return text.str();
}

RobustReport robust_optimize(PoseGraph& graph, const RobustOptions& options) {
  check(graph, options);
  const Roles roles = roles_of(graph, options);
  if (options.start == RobustStart::Odometry && options.warm_weights.empty()) go_to_odometry(graph, roles, options);
  Solution solution = solve(graph, roles, options);
  const std::vector<double> chi2 = evaluate_chi2(graph, options.optimize.objective);
  RobustReport report;
  report.last_solve = std::move(solution.last_solve);
  report.num_solves = solution.num_solves;
  report.is_proven = solution.is_proven;
  report.noise_scale = roles.noise_scale;
  report.noise = solution.noise;
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    EdgeDecision decision{chi2[e], solution.weights[e], roles.forced[e]};
    if (roles.is_doubted[e] && is_rejected(options.back_end, decision, roles.c2[e])) decision.verdict = EdgeVerdict::Rejected;
    const bool is_left_out = decision.verdict == EdgeVerdict::Rejected || decision.verdict == EdgeVerdict::ForcedReject;
    report.num_rejected += is_left_out;
    report.num_kept += !is_left_out && decision.verdict != EdgeVerdict::Trusted;
    report.edges.push_back(decision);
  }
  return report;
}

}  // namespace fabloop
