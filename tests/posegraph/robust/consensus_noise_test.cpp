// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/consensus_noise.h"

#include <gtest/gtest.h>

#include "posegraph/robust/noise_factors.h"
#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

const std::vector<EdgeKind> kJudgedLoops = {EdgeKind::Loop};
constexpr double kAgreeProbability = 0.999;

/// Errors twice those shown are allowed.
constexpr double kAllowed = 4.0;

/// A variance known from forty errors of an axis more than unknowns, to 6.33 standard deviations as in noise_factors_test.cpp.
constexpr double kVarianceSpread = 1.42;

PoseGraph laps_with_false_groups(std::uint32_t seed, double factor) {
  test::CircleOptions options;
  options.num_vertices = 400;
  options.sigma_translation_m = 0.02;
  options.sigma_rotation_rad = 0.005;
  options.seed = seed;
  options.dimension = 2;
  PoseGraph graph = with_noise(test::make_circle(options).graph, {factor, factor});
  // Groups that take a place for the one twenty steps before, too far from one another to agree: three loops of four.
  for (std::size_t from = 0; from + 30 < graph.vertices.size(); from += 25) {
    for (std::size_t k = 0; k < 8; ++k) {
      Edge edge = graph.edges.back();
      edge.from = from + k;
      edge.to = from + k + 20;
      edge.from_from_to = {};
      graph.edges.push_back(edge);
    }
  }
  return graph;
}

TEST(ConsensusNoise, IsThatOfTheRightLoopsAmongGroupsOfFalseOnes) {
  // Thirty times less promised than is held: a false group alone could be right.
  constexpr double kFactor = 900.0;
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const PoseGraph graph = laps_with_false_groups(seed, kFactor);
    const auto factor =
        consensus_rotation_factor(graph, LoopConsistency(graph, kJudgedLoops, kAgreeProbability), kJudgedLoops, {});
    ASSERT_TRUE(factor);
    EXPECT_NEAR(*factor * kFactor / kAllowed, 1.0, kVarianceSpread);
  }
}

TEST(ConsensusNoise, NeverAllowsMoreThanIsTold) {
  const PoseGraph graph = laps_with_false_groups(1, 0.8);
  const auto factor = consensus_rotation_factor(graph, LoopConsistency(graph, kJudgedLoops, kAgreeProbability), kJudgedLoops, {});
  ASSERT_TRUE(factor);
  EXPECT_EQ(*factor, 1.0);
}

TEST(ConsensusNoise, TakesTwoLoopsThatAgree) {
  PoseGraph graph = laps_with_false_groups(1, 1.0);
  std::erase_if(graph.edges, [](const Edge& edge) { return edge.kind == EdgeKind::Loop; });
  EXPECT_FALSE(consensus_rotation_factor(graph, LoopConsistency(graph, kJudgedLoops, kAgreeProbability), kJudgedLoops, {}));
}

}  // namespace
}  // namespace fabloop
