// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/noise_factors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

/// How far a factor may be from the truth: four standard deviations of a variance known from so many errors more than unknowns,
/// and 2.33 by which it is held back towards 1.
double spread(double degrees_of_freedom) { return 6.33 * std::sqrt(2.0 / degrees_of_freedom); }

/// Loops of solved_laps(): as many errors of an axis more than unknowns.
constexpr double kNumLoops = 400.0;

/// An optimum with a loop for every vertex of the second lap.
PoseGraph solved_laps(int dimension, const NoiseFactors& stated) {
  test::CircleOptions options;
  options.num_vertices = 400;
  options.sigma_translation_m = 0.02;
  options.sigma_rotation_rad = 0.005;
  options.dimension = dimension;
  test::Circle circle = test::make_circle(options);
  for (std::size_t seed = 2; seed <= 10; ++seed) {
    options.seed = static_cast<std::uint32_t>(seed);
    for (const Edge& edge : test::make_circle(options).truth.edges) {
      if (edge.kind == EdgeKind::Loop) circle.graph.edges.push_back(edge);
    }
  }
  PoseGraph graph = with_noise(circle.graph, stated);
  optimize(graph);
  return graph;
}

std::vector<double> ones(const PoseGraph& graph) { return std::vector<double>(graph.edges.size(), 1.0); }

TEST(NoiseFactors, AreOneForHonestMatrices) {
  for (const int dimension : {2, 3}) {
    const PoseGraph graph = solved_laps(dimension, {});
    const NoiseFactors factors = estimate_noise(graph, ones(graph), Objective::Chordal);
    EXPECT_NEAR(factors.translation, 1.0, spread(2.0 * kNumLoops));
    EXPECT_NEAR(factors.rotation, 1.0, spread(kNumLoops));
  }
}

TEST(NoiseFactors, TellTranslationsFromRotations) {
  // Matrices that promise a tenth of what translations hold, and twice what rotations do.
  const NoiseFactors stated{100.0, 0.25};
  for (const int dimension : {2, 3}) {
    for (const Objective objective : {Objective::Chordal, Objective::RotationVector, Objective::Quaternion}) {
      PoseGraph graph = solved_laps(dimension, stated);
      // Wrong weights bend the optimum; with the factors found it comes right.
      NoiseFactors found;
      for (int round = 0; round < 4; ++round) {
        const NoiseFactors factors = estimate_noise(graph, ones(graph), objective);
        graph = with_noise(graph, factors);
        OptimizeOptions options;
        options.objective = objective;
        optimize(graph, options);
        found = {found.translation * factors.translation, found.rotation * factors.rotation};
      }
      EXPECT_NEAR(found.translation * stated.translation, 1.0, spread(2.0 * kNumLoops)) << dimension << "-D";
      EXPECT_NEAR(found.rotation * stated.rotation, 1.0, spread(kNumLoops)) << dimension << "-D";
    }
  }
}

TEST(NoiseFactors, StayNearOneWhereLittleIsKnown) {
  test::CircleOptions options;
  options.num_vertices = 12;
  options.sigma_translation_m = 0.02;
  options.sigma_rotation_rad = 0.005;
  PoseGraph graph = test::make_circle(options).graph;
  // Odometry alone fits anyhow; nothing is learnt from it.
  std::vector<double> weights = ones(graph);
  for (std::size_t e = 0; e < weights.size(); ++e) weights[e] = graph.edges[e].kind == EdgeKind::Odometry ? 1.0 : 0.0;
  const NoiseFactors factors = estimate_noise(graph, weights, Objective::Chordal);
  EXPECT_EQ(factors.translation, 1.0);
  EXPECT_EQ(factors.rotation, 1.0);
}

TEST(NoiseFactors, OfTheMedianStretchAreThoseOfTheMapWhereOnePartIsBent) {
  for (const int dimension : {2, 3}) {
    PoseGraph graph = solved_laps(dimension, {});
    const NoiseFactors whole = estimate_noise(graph, ones(graph), Objective::Chordal, NoiseMean::OfMedianStretch);
    // A median of stretches knows pi / 2 times less than the mean of all.
    const double known = kNumLoops * 2.0 / std::numbers::pi;
    EXPECT_NEAR(whole.translation, 1.0, spread(2.0 * known)) << dimension << "-D";
    EXPECT_NEAR(whole.rotation, 1.0, spread(known)) << dimension << "-D";
    for (std::size_t v = 380; v < 390; ++v) {
      Edge wrong = graph.edges.back();
      wrong.from = v;
      wrong.to = v + 5;
      wrong.from_from_to = graph.vertices[wrong.from].world_from_frame.inverse() * graph.vertices[wrong.to].world_from_frame *
                           test::shift(1.0, 0.0, 0.0);
      graph.edges.push_back(wrong);
    }
    optimize(graph);
    const NoiseFactors of_all = estimate_noise(graph, ones(graph), Objective::Chordal);
    EXPECT_GT(of_all.translation, 1.0 + spread(2.0 * known)) << "the part must be bent";
    const NoiseFactors bent = estimate_noise(graph, ones(graph), Objective::Chordal, NoiseMean::OfMedianStretch);
    EXPECT_NEAR(bent.translation, 1.0, spread(2.0 * known)) << dimension << "-D";
    EXPECT_NEAR(bent.rotation, 1.0, spread(known)) << dimension << "-D";
  }
}

TEST(NoiseFactors, LeftOutEdgesDoNotCount) {
  PoseGraph graph = solved_laps(3, {});
  const NoiseFactors before = estimate_noise(graph, ones(graph), Objective::Chordal);
  Edge wrong = graph.edges.back();
  wrong.from_from_to.translation.x() += 100.0;
  graph.edges.push_back(wrong);
  std::vector<double> weights = ones(graph);
  weights.back() = 0.0;
  EXPECT_EQ(estimate_noise(graph, weights, Objective::Chordal).translation, before.translation);
}

}  // namespace
}  // namespace fabloop
