// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/truncated_choice.h"

#include <algorithm>
#include <utility>

#include "posegraph/robust/weighted_solve.h"

namespace fabloop {
namespace {

/// Alternations of choice and solve, and how far each solve goes.
constexpr int kMaxSettling = 10;
constexpr int kIterationsOfTrial = 20;
constexpr double kToleranceOfTrial = 1e-4;

/// Chi-square, in thresholds, of what is let in when settling wider.
constexpr double kReach = 9.0;

}  // namespace

double truncated_cost(const TruncatedProblem& problem, const std::vector<double>& chi2) {
  double cost = 0.0;
  for (std::size_t e = 0; e < chi2.size(); ++e) {
    cost += problem.is_doubted[e] ? std::min(chi2[e], problem.c2[e]) : problem.weights[e] * chi2[e];
  }
  return cost;
}

TruncatedChoice settle(PoseGraph graph, const TruncatedProblem& problem, OptimizeOptions optimize,
                       const std::vector<double>& known_weights) {
  optimize.robust_loss = RobustLoss::None;
  optimize.max_iterations = std::min(optimize.max_iterations, kIterationsOfTrial);
  optimize.cost_tolerance = kToleranceOfTrial;
  EdgeWeights edges{problem.weights, std::vector<bool>(graph.edges.size(), false)};
  TruncatedChoice choice;
  for (int k = 0; k < kMaxSettling; ++k) {
    solve_weighted(graph, edges, optimize);
    optimize.initialization = Initialization::AsGiven;
    ++choice.num_solves;
    choice.chi2 = evaluate_chi2(graph, optimize.objective);
    bool has_changed = false;
    for (std::size_t e = 0; e < choice.chi2.size(); ++e) {
      if (!problem.is_doubted[e]) continue;
      const double weight = choice.chi2[e] <= problem.c2[e] ? 1.0 : 0.0;
      has_changed = has_changed || weight != edges.weights[e];
      edges.weights[e] = weight;
    }
    if (!has_changed || edges.weights == known_weights) break;
  }
  choice.vertices = std::move(graph.vertices);
  choice.weights = std::move(edges.weights);
  choice.cost = choice.fitted_cost = truncated_cost(problem, choice.chi2);
  for (std::size_t e = 0; e < choice.chi2.size(); ++e) {
    if (problem.is_doubted[e] && choice.chi2[e] > problem.c2[e]) choice.fitted_cost -= problem.c2[e];
  }
  return choice;
}

TruncatedChoice settle_wider(const PoseGraph& graph, const TruncatedProblem& problem, const OptimizeOptions& optimize) {
  const std::vector<double> chi2 = evaluate_chi2(graph, optimize.objective);
  TruncatedProblem wider = problem;
  for (std::size_t e = 0; e < chi2.size(); ++e) {
    if (problem.is_doubted[e] && chi2[e] <= kReach * problem.c2[e]) wider.weights[e] = 1.0;
  }
  TruncatedChoice choice = settle(graph, wider, optimize);
  if (choice.cost <= truncated_cost(problem, chi2)) return choice;
  const std::size_t num_solves = choice.num_solves;
  choice = settle(graph, problem, optimize);
  choice.num_solves += num_solves;
  return choice;
}

}  // namespace fabloop
