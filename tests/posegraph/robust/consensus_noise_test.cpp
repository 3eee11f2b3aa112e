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

/// Of a graph whose loops are all doubted.
std::optional<double> factor_of(const PoseGraph& graph, const std::vector<std::size_t>& rejected = {}) {
  std::vector<double> sure_weights;
  std::vector<bool> is_doubted;
  for (const Edge& edge : graph.edges) {
    is_doubted.push_back(edge.kind == EdgeKind::Loop);
    sure_weights.push_back(is_doubted.back() ? 0.0 : 1.0);
  }
  for (const std::size_t e : rejected) is_doubted[e] = false;
  return consensus_rotation_factor(graph, LoopConsistency(graph, kJudgedLoops, kAgreeProbability), kJudgedLoops, sure_weights,
                                   is_doubted, {});
}

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
    const auto factor = factor_of(graph);
    ASSERT_TRUE(factor);
    EXPECT_LT(*factor * kFactor / kAllowed, 1.0 + kVarianceSpread);
    EXPECT_GT(*factor * kFactor / kAllowed, 1.0 / (1.0 + kVarianceSpread));
  }
}

TEST(ConsensusNoise, NeverAllowsMoreThanIsTold) {
  const PoseGraph graph = laps_with_false_groups(1, 0.8);
  const auto factor = factor_of(graph);
  ASSERT_TRUE(factor);
  EXPECT_EQ(*factor, 1.0);
}

TEST(ConsensusNoise, LoopsThatAPersonRejectedHaveNoSay) {
  const PoseGraph graph = laps_with_false_groups(1, 1.0);
  std::vector<std::size_t> loops;
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    if (graph.edges[e].kind == EdgeKind::Loop) loops.push_back(e);
  }
  EXPECT_TRUE(factor_of(graph));
  EXPECT_FALSE(factor_of(graph, loops));
}

TEST(ConsensusNoise, TakesTwoLoopsThatAgree) {
  PoseGraph graph = laps_with_false_groups(1, 1.0);
  bool has_one = false;
  std::erase_if(graph.edges, [&](const Edge& edge) {
    const bool is_first = edge.kind == EdgeKind::Loop && !has_one;
    has_one = has_one || is_first;
    return edge.kind == EdgeKind::Loop && !is_first;
  });
  ASSERT_TRUE(has_one);
  EXPECT_FALSE(factor_of(graph));
}

}  // namespace
}  // namespace fabloop
