// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/cluster_exchange.h"

#include <gtest/gtest.h>

#include <numeric>

#include "posegraph/robust/weighted_solve.h"
#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

const std::vector<EdgeKind> kExchangedLoops = {EdgeKind::Loop};
constexpr double kProbability = 0.999;

/// Two laps whose odometry drifts by many times what a loop may err.
test::Circle drifting_circle(std::uint32_t seed, int dimension = 3, double sigma_rotation_rad = 0.01) {
  test::CircleOptions options;
  options.num_vertices = 160;
  options.sigma_translation_m = 0.02;
  options.sigma_rotation_rad = sigma_rotation_rad;
  options.seed = seed;
  options.dimension = dimension;
  return test::make_circle(options);
}

/// Consecutive vertices of one stretch taken for those of another, all with the same error, in a map as it truly is.
std::vector<std::size_t> add_false_group(PoseGraph& graph, const PoseGraph& truth, std::size_t from, std::size_t to,
                                         std::size_t size) {
  const auto pose_of = [&](std::size_t v) { return truth.vertices[v].world_from_frame; };
  const Pose false_first = pose_of(from).inverse() * pose_of(to) * test::shift(3.0, -2.0, 0.0);
  std::vector<std::size_t> added;
  for (std::size_t k = 0; k < size; ++k) {
    Edge edge = graph.edges.back();
    edge.from = from + k;
    edge.to = to + k;
    edge.from_from_to = pose_of(from + k).inverse() * pose_of(from) * false_first * pose_of(to).inverse() * pose_of(to + k);
    added.push_back(graph.edges.size());
    graph.edges.push_back(edge);
  }
  return added;
}

TruncatedProblem problem_of(const PoseGraph& graph, double weight_of_loops) {
  TruncatedProblem problem{thresholds(graph, kProbability), {}, {}};
  for (const Edge& edge : graph.edges) {
    problem.is_doubted.push_back(edge.kind == EdgeKind::Loop);
    problem.weights.push_back(edge.kind == EdgeKind::Loop ? weight_of_loops : 1.0);
  }
  return problem;
}

ClusterExchange exchange(PoseGraph& graph, const TruncatedProblem& problem, std::size_t max_rounds = 10) {
  const LoopConsistency loops(graph, kExchangedLoops, kProbability);
  ClusterExchangeOptions options;
  options.max_rounds = max_rounds;
  options.begins_anew = false;
  return exchange_clusters(graph, problem, loops, kExchangedLoops, {}, options);
}

double num_loops(const PoseGraph& graph, const std::vector<double>& weights) {
  return std::accumulate(weights.begin(), weights.end(), 0.0) - static_cast<double>(graph.vertices.size() - 1);
}

TEST(ClusterExchange, LetsInRightLoopsThatLieFarFromABadStart) {
  for (const int dimension : {2, 3}) {
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
      const test::Circle circle = drifting_circle(seed, dimension);
      const TruncatedProblem problem = problem_of(circle.graph, 0.0);
      PoseGraph stuck = circle.graph;
      const double before = exchange(stuck, problem, 0).cost;
      ASSERT_LT(num_loops(stuck, exchange(stuck, problem, 0).weights), 8.0) << "the start must be a bad one";
      PoseGraph graph = circle.graph;
      const ClusterExchange found = exchange(graph, problem);
      EXPECT_EQ(num_loops(graph, found.weights), 16.0) << dimension << "-D, seed " << seed;
      EXPECT_LT(found.cost, before);
      EXPECT_GE(found.num_let_in, 1u);
      PoseGraph optimum = circle.graph;
      optimize(optimum);
      EXPECT_LT(test::largest_distance(graph, optimum), 0.01);
    }
  }
}

TEST(ClusterExchange, LeavesOutAGroupThatTheMapHasBentTo) {
  const test::Circle circle = drifting_circle(1, 3, 0.002);
  PoseGraph all = circle.graph;
  const auto added = add_false_group(all, circle.truth, 20, 57, 12);
  optimize(all);
  const TruncatedProblem problem = problem_of(all, 1.0);
  PoseGraph stuck = all;
  const ClusterExchange without_exchange = exchange(stuck, problem, 0);
  double num_false_at_first = 0.0;
  for (const std::size_t e : added) num_false_at_first += without_exchange.weights[e];
  ASSERT_GT(num_false_at_first, 0.0) << "the group must hold out against choosing and solving in turns";
  const ClusterExchange found = exchange(all, problem);
  EXPECT_LT(found.cost, without_exchange.cost);
  for (const std::size_t e : added) EXPECT_EQ(found.weights[e], 0.0);
  EXPECT_EQ(num_loops(all, found.weights), 16.0);
}

TEST(ClusterExchange, PrefersTheFewerRightLoopsWhereMoreFalseOnesAgree) {
  // At one place the false group is larger than all right loops around it; the map as a whole decides.
  const test::Circle circle = drifting_circle(2, 3, 0.002);
  PoseGraph graph = circle.graph;
  const auto added = add_false_group(graph, circle.truth, 20, 57, 12);
  TruncatedProblem problem = problem_of(graph, 1.0);
  for (std::size_t e = 0; e < added.front(); ++e) {
    const Edge& edge = graph.edges[e];
    if (edge.kind == EdgeKind::Loop && edge.from >= 20 && edge.from < 40) problem.weights[e] = 0.0;
  }
  const ClusterExchange found = exchange(graph, problem);
  for (const std::size_t e : added) EXPECT_EQ(found.weights[e], 0.0);
  EXPECT_EQ(num_loops(graph, found.weights), 16.0);
}

TEST(ClusterExchange, BeginsAnewWhereAFalseGroupHasBentTheMap) {
  const test::Circle circle = drifting_circle(1, 3, 0.002);
  PoseGraph bent = circle.graph;
  const std::size_t num_right = bent.edges.size();
  add_false_group(bent, circle.truth, 20, 57, 12);
  optimize(bent);
  const TruncatedProblem problem = problem_of(bent, 1.0);
  const LoopConsistency loops(bent, kExchangedLoops, kProbability);
  ClusterExchangeOptions options;
  options.max_rounds = 0;
  options.begins_anew = false;
  PoseGraph stuck = bent;
  const ClusterExchange as_it_was = exchange_clusters(stuck, problem, loops, kExchangedLoops, {}, options);
  options.begins_anew = true;
  const ClusterExchange anew = exchange_clusters(bent, problem, loops, kExchangedLoops, {}, options);
  EXPECT_LT(anew.cost, 0.5 * as_it_was.cost);
  for (std::size_t e = 0; e < anew.weights.size(); ++e) EXPECT_EQ(anew.weights[e], e < num_right ? 1.0 : 0.0) << e;
}

TEST(ClusterExchange, KeepsWhatIsNotDoubted) {
  const test::Circle circle = drifting_circle(3);
  PoseGraph graph = circle.graph;
  const auto added = add_false_group(graph, circle.truth, 20, 57, 2);
  TruncatedProblem problem = problem_of(graph, 1.0);
  for (const std::size_t e : added) problem.is_doubted[e] = false;
  problem.is_doubted[added[0] - 1] = false;
  problem.weights[added[0] - 1] = 0.0;
  const ClusterExchange found = exchange(graph, problem);
  for (const std::size_t e : added) EXPECT_EQ(found.weights[e], 1.0);
  EXPECT_EQ(found.weights[added[0] - 1], 0.0);
}

}  // namespace
}  // namespace fabloop
