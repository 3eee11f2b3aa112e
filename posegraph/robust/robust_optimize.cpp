// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/robust_optimize.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <string>

#include "frontend/error.h"
#include "frontend/names.h"
#include "posegraph/robust/consistent_loops.h"
#include "posegraph/robust/graduated_back_ends.h"
#include "posegraph/robust/loop_consistency.h"
#include "posegraph/robust/loop_roles.h"
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

/// Poses chained along the trusted edges, several sessions placed by the loops that agree, then settled between the trusted edges
/// and the loops accepted by force.
void go_to_odometry(PoseGraph& graph, const LoopRoles& roles, const RobustOptions& options) {
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

BackEndSolution solve_with_loss(PoseGraph& graph, const LoopRoles& roles, const RobustOptions& options) {
  EdgeWeights edges = weights_of(roles, 1.0);
  edges.has_loss = roles.is_doubted;
  OptimizeOptions with_loss = options.optimize;
  with_loss.robust_loss = loss_of(options.back_end);
  with_loss.robust_probability = options.inlier_probability;
  BackEndSolution solution{solve_weighted(graph, edges, with_loss, roles.noise_scale), edges.weights};
  const std::vector<double> chi2 = evaluate_chi2(graph, options.optimize.objective);
  for (std::size_t e = 0; e < chi2.size(); ++e) {
    if (roles.is_doubted[e]) solution.weights[e] = robust_weight(with_loss.robust_loss, chi2[e], roles.c2[e]);
  }
  return solution;
}

BackEndSolution solve_consistent(PoseGraph& graph, const LoopRoles& roles, const RobustOptions& options) {
  const LoopConsistency loops(graph, options.doubted, options.inlier_probability, roles.noise_scale);
  const ConsistentLoops found = most_consistent_loops(loops, options.max_clique_work);
  EdgeWeights edges = weights_of(roles, 0.0);
  for (const std::size_t loop : found.loops) {
    if (roles.is_doubted[loops.edges()[loop]]) edges.weights[loops.edges()[loop]] = 1.0;
  }
  BackEndSolution solution{solve_weighted(graph, edges, options.optimize), edges.weights};
  solution.is_proven = found.is_proven;
  return solution;
}

BackEndSolution solve_switchable(PoseGraph& graph, const LoopRoles& roles, const RobustOptions& options) {
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

BackEndSolution solve(PoseGraph& graph, const LoopRoles& roles, const RobustOptions& options) {
  switch (options.back_end) {
    case BackEnd::GncTruncated:
      return solve_truncated(graph, roles, options);
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
  const LoopRoles roles = roles_of(graph, options);
  if (options.start == RobustStart::Odometry && options.warm_weights.empty()) go_to_odometry(graph, roles, options);
  BackEndSolution solution = solve(graph, roles, options);
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
