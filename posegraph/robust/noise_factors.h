// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"

namespace fabloop {

/// By what the variances that information matrices tell are to be multiplied to be those that the edges show.
struct NoiseFactors {
  double translation = 1.0;  ///< Of translations, and of directions where an edge has no scale.
  double rotation = 1.0;
};

/// By what the chi-squares of an objective exceed those of honest errors: planar rotations count twice under `Chordal`, whose
/// kappa is I_33 as SE-Sync has it.
NoiseFactors factors_of_objective(Objective objective, int dimension);

/// The graph whose chi-squares under the objective are those of honest errors.
PoseGraph judged_honestly(PoseGraph graph, Objective objective);

/// One after the other.
NoiseFactors operator*(const NoiseFactors& a, const NoiseFactors& b);

/// Over what estimate_noise() averages.
enum class NoiseMean {
  /// Median of up to eleven stretches of the map, each with an equal share of the redundancy: false loops that have bent one part
  /// of the map do not pass for noise (medians of means: Nemirovsky & Yudin, Problem Complexity and Method Efficiency in
  /// Optimization, 1983).
  OfMedianStretch,
  /// All edges: what says most where nothing false is left.
  OfAll,
};

/// Variance components of a graph at its optimum (Helmert 1907; Koch, Parameter Estimation and Hypothesis Testing in Linear
/// Models, 1999, section 3.6): the sum of squared errors of translations over what is left of their number when each vertex
/// has taken its three, and the same for rotations; what the objective itself adds is taken off. Edges of weight 0 do not count.
/// A factor is moved from 1 no further than the errors show with `probability`, since few loops show little; and it stays above a
/// millionth, where solves end. 1 for a graph with priors: what these pull is not told from how far edges err.
NoiseFactors estimate_noise(const PoseGraph& graph, const std::vector<double>& weights, Objective objective,
                            NoiseMean mean = NoiseMean::OfAll, double probability = 0.99);

/// The graph with the information of its edges divided by the factors.
PoseGraph with_noise(PoseGraph graph, const NoiseFactors& factors);

}  // namespace fabloop
