// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/residuals/graph_costs.h"

#include <algorithm>
#include <array>

#include "posegraph/residuals/residuals.h"
#include "verification/chi_square.h"

namespace fabloop {
namespace {

double squared_error(const ceres::CostFunction& residual, const std::vector<double*>& blocks) {
  std::array<double, residuals::kMaxSize> errors{};
  residual.Evaluate(blocks.data(), errors.data(), nullptr);
  double chi2 = 0.0;
  for (const double e : errors) chi2 += e * e;
  return chi2;
}

std::vector<EdgeLoss> edge_losses(const PoseGraph& graph, const OptimizeOptions& options) {
  // Of 5 and 6 errors in space, 3 in the plane.
  std::array<double, residuals::kMaxSize + 1> c2{};
  for (const int degrees_of_freedom : {3, 5, 6}) {
    c2[degrees_of_freedom] = chi_square_quantile(options.robust_probability, degrees_of_freedom);
  }
  std::vector<EdgeLoss> losses;
  losses.reserve(graph.edges.size());
  for (const Edge& edge : graph.edges) {
    const auto& kinds = options.robust_kinds;
    const bool is_robust = std::find(kinds.begin(), kinds.end(), edge.kind) != kinds.end();
    const int degrees_of_freedom = graph.dimension == 2 ? 3 : edge.has_scale ? 6 : 5;
    losses.push_back(is_robust ? EdgeLoss{options.robust_loss, c2[degrees_of_freedom]} : EdgeLoss{});
  }
  return losses;
}

}  // namespace

GraphCosts::GraphCosts(const PoseGraph& graph, const OptimizeOptions& options)
    : graph_(graph), losses_(edge_losses(graph, options)), world_(std::make_unique<State>()) {
  edge_residuals_.reserve(graph.edges.size());
  for (const Edge& edge : graph.edges) {
    edge_residuals_.push_back(residuals::make_residual(edge, graph.dimension, options.objective));
  }
  for (const VertexPrior& prior : graph.priors) {
    prior_residuals_.push_back(residuals::make_residual(prior, graph.dimension, options.objective));
  }
  world_->fill(0.0);
  constexpr std::size_t kRealPart = 3;
  if (graph.dimension == 3) (*world_)[kRealPart] = 1.0;
}

std::vector<EdgeResult> GraphCosts::evaluate_edges(std::vector<State>& states) const {
  std::vector<EdgeResult> results;
  results.reserve(graph_.edges.size());
  for (std::size_t e = 0; e < graph_.edges.size(); ++e) {
    const double chi2 = squared_error(*edge_residuals_[e], blocks_of(graph_.edges[e], graph_.dimension, states));
    results.push_back({chi2, robust_weight(losses_[e].loss, chi2, losses_[e].c2)});
  }
  return results;
}

std::vector<EdgeResult> GraphCosts::evaluate_priors(std::vector<State>& states) const {
  std::vector<EdgeResult> results;
  results.reserve(graph_.priors.size());
  for (std::size_t p = 0; p < graph_.priors.size(); ++p) {
    results.push_back({squared_error(*prior_residuals_[p], blocks_of_prior(graph_.priors[p], states)), 1.0});
  }
  return results;
}

double GraphCosts::sum(const std::vector<EdgeResult>& edges, const std::vector<EdgeResult>& priors) const {
  double cost = 0.0;
  for (std::size_t e = 0; e < edges.size(); ++e) cost += robust_cost(losses_[e].loss, edges[e].chi2, losses_[e].c2);
  for (const EdgeResult& prior : priors) cost += prior.chi2;
  return cost;
}

std::vector<double*> GraphCosts::blocks_of_prior(const VertexPrior& prior, std::vector<State>& states) const {
  double* const vertex = states[prior.vertex].data();
  if (prior.kind == PriorKind::Attitude) return {vertex};
  if (graph_.dimension == 2) return {world_->data(), vertex};
  return {world_->data(), world_->data() + 4, vertex, vertex + 4};
}

std::vector<double*> GraphCosts::world_blocks() const {
  const bool is_used = std::any_of(graph_.priors.begin(), graph_.priors.end(),
                                   [](const VertexPrior& prior) { return prior.kind != PriorKind::Attitude; });
  if (!is_used) return {};
  if (graph_.dimension == 2) return {world_->data()};
  return {world_->data(), world_->data() + 4};
}

}  // namespace fabloop
