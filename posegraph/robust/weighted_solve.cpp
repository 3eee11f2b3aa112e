// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/weighted_solve.h"

#include <cassert>
#include <utility>

#include "verification/chi_square.h"

namespace fabloop {

OptimizeReport solve_weighted(PoseGraph& graph, const EdgeWeights& edges, OptimizeOptions options, double noise_scale) {
  assert(edges.weights.size() == graph.edges.size() && edges.has_loss.size() == graph.edges.size());
  PoseGraph weighted;
  weighted.dimension = graph.dimension;
  weighted.vertices = std::move(graph.vertices);
  weighted.priors = graph.priors;
  for (VertexPrior& prior : weighted.priors) prior.information /= noise_scale;  // as the edges: only ratios place the vertices
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    if (edges.weights[e] == 0.0) continue;
    Edge edge = graph.edges[e];
    edge.information *= edges.weights[e] / noise_scale;
    // The kinds only tell optimize() who gets a loss.
    edge.kind = edges.has_loss[e] ? EdgeKind::Loop : EdgeKind::Odometry;
    weighted.edges.push_back(edge);
  }
  options.robust_kinds = {EdgeKind::Loop};
  OptimizeReport report = optimize(weighted, options);
  graph.vertices = std::move(weighted.vertices);
  return report;
}

Initialization relaxation_of(const OptimizeOptions& options) {
  return options.freedom == Freedom::Full ? Initialization::Chordal : Initialization::AsGiven;
}

std::vector<double> thresholds(const PoseGraph& graph, double probability) {
  const double planar = chi_square_quantile(probability, 3);
  const double direction = chi_square_quantile(probability, 5);
  const double spatial = chi_square_quantile(probability, 6);
  std::vector<double> result;
  result.reserve(graph.edges.size());
  for (const Edge& edge : graph.edges) result.push_back(graph.dimension == 2 ? planar : edge.has_scale ? spatial : direction);
  return result;
}

std::vector<double> evaluate_chi2(const PoseGraph& graph, Objective objective) {
  OptimizeOptions options;
  options.objective = objective;
  std::vector<double> result;
  result.reserve(graph.edges.size());
  for (const EdgeResult& edge : evaluate_edges(graph, options)) result.push_back(edge.chi2);
  return result;
}

}  // namespace fabloop
