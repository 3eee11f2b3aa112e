// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/noise_factors.h"

#include <algorithm>
#include <cmath>

#include "posegraph/connectivity.h"
#include "posegraph/robust/weighted_solve.h"
#include "verification/chi_square.h"

namespace fabloop {
namespace {

/// Sum of squares that should be chi-square with so many degrees of freedom.
struct Component {
  double sum = 0.0;
  double degrees_of_freedom = 0.0;
};

/// The factor nearest to 1 that the sum does not contradict.
double factor_of(const Component& component, double probability) {
  constexpr double kLeast = 1e-6;
  // Beyond so many, the bounds hardly move.
  constexpr double kMany = 1000.0;
  if (component.degrees_of_freedom < 1.0) return 1.0;
  const double factor = component.sum / component.degrees_of_freedom;
  const int count = static_cast<int>(std::min(component.degrees_of_freedom, kMany));
  const double lowest = factor * count / chi_square_quantile(probability, count);
  const double highest = factor * count / chi_square_quantile(1.0 - probability, count);
  return std::max(kLeast, std::clamp(1.0, lowest, highest));
}

}  // namespace

NoiseFactors factors_of_objective(Objective objective, int dimension) {
  return {1.0, dimension == 2 && objective == Objective::Chordal ? 2.0 : 1.0};
}

NoiseFactors operator*(const NoiseFactors& a, const NoiseFactors& b) {
  return {a.translation * b.translation, a.rotation * b.rotation};
}

NoiseFactors estimate_noise(const PoseGraph& graph, const std::vector<double>& weights, Objective objective, double probability) {
  if (!graph.priors.empty()) return {};
  PoseGraph translations = graph;
  PoseGraph rotations = graph;
  Component translation;
  Component rotation;
  PoseGraph kept = graph;
  kept.edges.clear();
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    rotations.edges[e].information.leftCols<3>().setZero();
    rotations.edges[e].information.topRows<3>().setZero();
    translations.edges[e].information.rightCols<3>().setZero();
    translations.edges[e].information.bottomRows<3>().setZero();
    if (weights[e] == 0.0) continue;
    kept.edges.push_back(graph.edges[e]);
    translation.degrees_of_freedom += graph.dimension == 2 || !graph.edges[e].has_scale ? 2.0 : 3.0;
    rotation.degrees_of_freedom += graph.dimension == 2 ? 1.0 : 3.0;
  }
  const std::vector<double> of_translations = evaluate_chi2(translations, objective);
  const std::vector<double> of_rotations = evaluate_chi2(rotations, objective);
  const NoiseFactors of_objective = factors_of_objective(objective, graph.dimension);
  for (std::size_t e = 0; e < weights.size(); ++e) {
    translation.sum += weights[e] * of_translations[e] / of_objective.translation;
    rotation.sum += weights[e] * of_rotations[e] / of_objective.rotation;
  }
  const auto num_free = static_cast<double>(graph.vertices.size() - find_anchors(graph, connected_components(kept)).size());
  translation.degrees_of_freedom -= graph.dimension * num_free;
  rotation.degrees_of_freedom -= (graph.dimension == 2 ? 1.0 : 3.0) * num_free;
  return {factor_of(translation, probability), factor_of(rotation, probability)};
}

PoseGraph with_noise(PoseGraph graph, const NoiseFactors& factors) {
  for (Edge& edge : graph.edges) {
    edge.information.topLeftCorner<3, 3>() /= factors.translation;
    edge.information.bottomRightCorner<3, 3>() /= factors.rotation;
    edge.information.topRightCorner<3, 3>() /= std::sqrt(factors.translation * factors.rotation);
    edge.information.bottomLeftCorner<3, 3>() /= std::sqrt(factors.translation * factors.rotation);
  }
  return graph;
}

}  // namespace fabloop
