// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/false_loops.h"

#include <gtest/gtest.h>

#include "frontend/error.h"
#include "posegraph/robust/loop_consistency.h"
#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

std::size_t count_loops(const PoseGraph& graph) {
  return static_cast<std::size_t>(
      std::count_if(graph.edges.begin(), graph.edges.end(), [](const Edge& edge) { return edge.kind == EdgeKind::Loop; }));
}

TEST(FalseLoops, AreTheShareThatWasAskedFor) {
  for (const double share : {0.0, 0.1, 0.5, 0.9}) {
    for (const FalseLoopPattern pattern : {FalseLoopPattern::Random, FalseLoopPattern::Groups}) {
      PoseGraph graph = test::make_circle().truth;
      const auto added = add_false_loops(graph, {pattern, share, 4, 1});
      check(graph);
      const auto num_loops = static_cast<double>(count_loops(graph));
      EXPECT_NEAR(static_cast<double>(added.size()), share * num_loops, 0.5);
      for (const std::size_t e : added) EXPECT_EQ(graph.edges[e].kind, EdgeKind::Loop);
    }
  }
}

TEST(FalseLoops, AreTheSameForTheSameSeedAndOthersForAnother) {
  const auto with_seed = [](std::uint64_t seed) {
    PoseGraph graph = test::make_circle().truth;
    add_false_loops(graph, {FalseLoopPattern::Random, 0.5, 10, seed});
    return graph.edges;
  };
  const auto first = with_seed(1);
  const auto again = with_seed(1);
  const auto other = with_seed(2);
  ASSERT_EQ(first.size(), again.size());
  std::size_t num_different = 0;
  for (std::size_t e = 0; e < first.size(); ++e) {
    EXPECT_EQ(first[e].from, again[e].from);
    EXPECT_EQ(first[e].to, again[e].to);
    EXPECT_EQ(first[e].from_from_to.translation, again[e].from_from_to.translation);
    num_different += first[e].from != other[e].from;
  }
  EXPECT_GT(num_different, 0u);
}

TEST(FalseLoops, OfAGroupAgreeWithOneAnother) {
  test::CircleOptions circle;
  circle.num_vertices = 200;
  circle.sigma_translation_m = 0.02;
  circle.sigma_rotation_rad = 0.005;
  PoseGraph graph = test::make_circle(circle).truth;
  FalseLoopOptions options;
  options.pattern = FalseLoopPattern::Groups;
  options.group_size = 5;
  const auto added = add_false_loops(graph, options);
  const LoopConsistency loops(graph, {EdgeKind::Loop}, 0.9999);
  const std::size_t first = loops.size() - added.size();
  for (std::size_t k = 0; k + 1 < options.group_size; ++k) EXPECT_TRUE(loops.are_consistent(first + k, first + k + 1));
}

TEST(FalseLoops, NeedLoopsToBeLike) {
  PoseGraph graph = test::make_circle().truth;
  EXPECT_THROW(add_false_loops(graph, {FalseLoopPattern::Random, 1.0, 10, 1}), InputError);
  std::erase_if(graph.edges, [](const Edge& edge) { return edge.kind == EdgeKind::Loop; });
  EXPECT_THROW(add_false_loops(graph), InputError);
}

}  // namespace
}  // namespace fabloop
