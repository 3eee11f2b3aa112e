// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/noise_factors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "posegraph/connectivity.h"
#include "posegraph/robust/weighted_solve.h"
#include "verification/chi_square.h"

namespace fabloop {
namespace {

/// Of the redundancy (edges less free vertices): what a stretch has at least, and how many stretches say enough.
constexpr double kLeastRedundancy = 50.0;
constexpr std::size_t kMaxStretches = 11;

/// Sum of squares that should be chi-square with so many degrees of freedom.
struct Component {
  double sum = 0.0;
  double degrees_of_freedom = 0.0;
};

/// Vertices in order, cut so that each stretch has an equal share of the redundancy.
struct Stretches {
  std::vector<std::size_t> of_vertex;
  std::vector<bool> is_free;  ///< One a vertex.
  std::size_t count = 1;      ///< Odd.
};

Stretches cut_into_stretches(const PoseGraph& graph, std::size_t max_count) {
  Stretches stretches;
  stretches.is_free.assign(graph.vertices.size(), true);
  for (const std::size_t v : find_anchors(graph, connected_components(graph))) stretches.is_free[v] = false;
  std::vector<double> redundancy(graph.vertices.size(), 0.0);
  for (const Edge& edge : graph.edges) {
    redundancy[edge.from] += 0.5;
    redundancy[edge.to] += 0.5;
  }
  double total = 0.0;
  for (std::size_t v = 0; v < redundancy.size(); ++v) total += redundancy[v] -= stretches.is_free[v] ? 1.0 : 0.0;
  while (stretches.count + 2 <= max_count && kLeastRedundancy * static_cast<double>(stretches.count + 2) <= total) {
    stretches.count += 2;
  }
  double before = 0.0;
  std::size_t stretch = 0;
  for (const double of_vertex : redundancy) {
    before += of_vertex;
    while (stretch + 1 < stretches.count &&
           before * static_cast<double>(stretches.count) >= total * static_cast<double>(stretch + 1)) {
      ++stretch;
    }
    stretches.of_vertex.push_back(stretch);
  }
  return stretches;
}

/// The factor nearest to 1 that the median of the stretches does not contradict.
double factor_of(const std::vector<Component>& stretches, double probability) {
  constexpr double kLeast = 1e-6;
  // Beyond so many, the bounds hardly move.
  constexpr double kMany = 1000.0;
  // Of a median beside the mean, for many stretches.
  constexpr double kEfficiency = 2.0 / std::numbers::pi;
  double degrees_of_freedom = 0.0;
  std::vector<double> factors;
  for (const Component& stretch : stretches) {
    degrees_of_freedom += stretch.degrees_of_freedom;
    factors.push_back(stretch.sum / stretch.degrees_of_freedom);
  }
  if (factors.size() > 1) degrees_of_freedom *= kEfficiency;
  if (degrees_of_freedom < 1.0) return 1.0;
  const auto median = factors.begin() + static_cast<std::ptrdiff_t>(factors.size() / 2);
  std::nth_element(factors.begin(), median, factors.end());
  const int count = static_cast<int>(std::min(degrees_of_freedom, kMany));
  const double lowest = *median * count / chi_square_quantile(probability, count);
  const double highest = *median * count / chi_square_quantile(1.0 - probability, count);
  return std::max(kLeast, std::clamp(1.0, lowest, highest));
}

}  // namespace

NoiseFactors factors_of_objective(Objective objective, int dimension) {
  return {1.0, dimension == 2 && objective == Objective::Chordal ? 2.0 : 1.0};
}

NoiseFactors operator*(const NoiseFactors& a, const NoiseFactors& b) {
  return {a.translation * b.translation, a.rotation * b.rotation};
}

NoiseFactors estimate_noise(const PoseGraph& graph, const std::vector<double>& weights, Objective objective, NoiseMean mean,
                            double probability) {
  if (!graph.priors.empty()) return {};
  PoseGraph translations = graph;
  PoseGraph rotations = graph;
  PoseGraph kept = graph;
  kept.edges.clear();
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    rotations.edges[e].information.leftCols<3>().setZero();
    rotations.edges[e].information.topRows<3>().setZero();
    translations.edges[e].information.rightCols<3>().setZero();
    translations.edges[e].information.bottomRows<3>().setZero();
    if (weights[e] != 0.0) kept.edges.push_back(graph.edges[e]);
  }
  const std::vector<double> of_translations = evaluate_chi2(translations, objective);
  const std::vector<double> of_rotations = evaluate_chi2(rotations, objective);
  const NoiseFactors of_objective = factors_of_objective(objective, graph.dimension);
  const Stretches stretches = cut_into_stretches(kept, mean == NoiseMean::OfAll ? 1 : kMaxStretches);
  std::vector<Component> translation(stretches.count);
  std::vector<Component> rotation(stretches.count);
  const double num_axes = graph.dimension;
  const double num_angles = graph.dimension == 2 ? 1.0 : 3.0;
  for (std::size_t e = 0; e < weights.size(); ++e) {
    if (weights[e] == 0.0) continue;
    const Edge& edge = graph.edges[e];
    // Half of an edge belongs to either end.
    for (const std::size_t v : {edge.from, edge.to}) {
      Component& translation_here = translation[stretches.of_vertex[v]];
      Component& rotation_here = rotation[stretches.of_vertex[v]];
      translation_here.sum += 0.5 * weights[e] * of_translations[e] / of_objective.translation;
      rotation_here.sum += 0.5 * weights[e] * of_rotations[e] / of_objective.rotation;
      translation_here.degrees_of_freedom += graph.dimension == 2 || !edge.has_scale ? 1.0 : 1.5;
      rotation_here.degrees_of_freedom += 0.5 * num_angles;
    }
  }
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    if (!stretches.is_free[v]) continue;
    translation[stretches.of_vertex[v]].degrees_of_freedom -= num_axes;
    rotation[stretches.of_vertex[v]].degrees_of_freedom -= num_angles;
  }
  return {factor_of(translation, probability), factor_of(rotation, probability)};
}

PoseGraph judged_honestly(PoseGraph graph, Objective objective) {
  const NoiseFactors of_objective = factors_of_objective(objective, graph.dimension);
  return with_noise(std::move(graph), of_objective);
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
