// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/loop_odds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "posegraph/robust/truncated_choice.h"
#include "posegraph/robust/weighted_solve.h"
#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

test::Circle circle_for_odds(int dimension) {
  test::CircleOptions options;
  options.num_vertices = 120;
  options.sigma_translation_m = 0.02;
  options.sigma_rotation_rad = 0.005;
  options.dimension = dimension;
  return test::make_circle(options);
}

TEST(LoopOdds, AreEvenWhereTheTwoDensitiesAreEqual) {
  // A square map in which positions vary by 50 m^2 an axis, and an edge that errs by 0.1 m and 0.02 rad.
  PoseGraph graph;
  graph.dimension = 2;
  for (int v = 0; v < 4; ++v) {
    Vertex vertex;
    vertex.id = v;
    const double half_side = std::sqrt(50.0);
    vertex.world_from_frame.translation = {v % 2 == 0 ? half_side : -half_side, v < 2 ? half_side : -half_side, 0.0};
    graph.vertices.push_back(vertex);
  }
  Edge edge;
  edge.from = 0;
  edge.to = 3;
  edge.kind = EdgeKind::Loop;
  edge.information.diagonal() << 100.0, 100.0, 1.0, 1.0, 1.0, 2500.0;
  graph.edges.push_back(edge);
  const double chi2 = even_odds_chi2(graph).front();
  using std::numbers::pi;
  const double log_right = -0.5 * chi2 - 1.5 * std::log(2.0 * pi) - std::log(0.1 * 0.1 * 0.02);
  // Differences of positions have twice their variance; the error of a right edge is added.
  const double log_false = -std::log(2.0 * pi * (100.0 + 0.01)) - std::log(2.0 * pi);
  EXPECT_NEAR(log_right, log_false, 1e-9);
  // Where nine of ten are false, a loop must fit better by their odds.
  EXPECT_NEAR(even_odds_chi2(graph, 0.9).front(), chi2 - 2.0 * std::log(9.0), 1e-9);
}

TEST(LoopOdds, DoNotDependOnTheWorldsFrameNorOnTheUnit) {
  for (const int dimension : {2, 3}) {
    const PoseGraph graph = circle_for_odds(dimension).graph;
    const std::vector<double> before = even_odds_chi2(graph);
    PoseGraph moved = graph;
    const Pose world_from_world{Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ())), {300.0, -20.0, 0.0}};
    constexpr double kScale = 100.0;
    for (Vertex& vertex : moved.vertices) {
      vertex.world_from_frame = world_from_world * vertex.world_from_frame;
      vertex.world_from_frame.translation *= kScale;
    }
    for (Edge& edge : moved.edges) edge.information.topLeftCorner<3, 3>() /= kScale * kScale;
    const std::vector<double> after = even_odds_chi2(moved);
    for (std::size_t e = 0; e < before.size(); ++e) EXPECT_NEAR(after[e], before[e], 1e-6) << dimension << "-D";
  }
}

TEST(LoopOdds, SayNothingWithoutScale) {
  PoseGraph graph = circle_for_odds(3).graph;
  graph.edges.back().has_scale = false;
  EXPECT_EQ(even_odds_chi2(graph).back(), 0.0);
}

TEST(TruncatedChoice, SettlingWiderBringsBackLoopsThatOnlyAMapWithoutThemContradicts) {
  for (const int dimension : {2, 3}) {
    const test::Circle circle = circle_for_odds(dimension);
    PoseGraph graph = circle.graph;
    TruncatedProblem problem{thresholds(graph, 0.999), {}, {}};
    for (const Edge& edge : graph.edges) {
      problem.is_doubted.push_back(edge.kind == EdgeKind::Loop);
      problem.weights.push_back(edge.kind == EdgeKind::Loop ? 0.0 : 1.0);
    }
    // The map of odometry alone, and thresholds half of what that map shows of the worst loop.
    TruncatedProblem none = problem;
    none.is_doubted.assign(graph.edges.size(), false);
    graph.vertices = settle(graph, none, {}).vertices;
    const std::vector<double> alone = evaluate_chi2(graph, Objective::Chordal);
    double largest = 0.0;
    for (std::size_t e = 0; e < alone.size(); ++e) largest = std::max(largest, problem.is_doubted[e] ? alone[e] : 0.0);
    for (double& c2 : problem.c2) c2 = std::max(c2, 0.5 * largest);
    // One false loop, far beyond.
    Edge false_loop = graph.edges.back();
    false_loop.from_from_to.translation.x() += 5.0;
    graph.edges.push_back(false_loop);
    problem.c2.push_back(problem.c2.back());
    problem.is_doubted.push_back(true);
    problem.weights.push_back(0.0);
    const TruncatedChoice choice = settle_wider(graph, problem, {});
    for (std::size_t e = 0; e + 1 < graph.edges.size(); ++e) EXPECT_EQ(choice.weights[e], 1.0) << dimension << "-D, edge " << e;
    EXPECT_EQ(choice.weights.back(), 0.0) << dimension << "-D";
    EXPECT_LE(choice.cost, truncated_cost(problem, evaluate_chi2(graph, Objective::Chordal)));
  }
}

}  // namespace
}  // namespace fabloop
