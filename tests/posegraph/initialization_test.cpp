// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/initialization.h"

#include <gtest/gtest.h>

#include "frontend/error.h"
#include "posegraph/optimize.h"
#include "tests/posegraph/random_graph.h"
#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

using test::largest_angle;
using test::largest_distance;
using test::random_graph;
using test::scatter;

/// Linear systems of a few dozen unknowns, solved in double precision; poses are a few metres apart.
constexpr double kRelaxationRounding = 1e-9;

TEST(Initialization, IsExactWhereAllEdgesAgreeWhateverThePosesWere) {
  for (const int dimension : {2, 3}) {
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
      const PoseGraph truth = random_graph(dimension, 30, 20, 0.0, seed);
      PoseGraph graph = truth;
      scatter(graph, seed);
      ASSERT_GT(largest_distance(graph, truth), 1.0);
      initialize_chordal(graph);
      EXPECT_LT(largest_distance(graph, truth), kRelaxationRounding);
      EXPECT_LT(largest_angle(graph, truth), kRelaxationRounding);
    }
  }
}

TEST(Initialization, KeepsFixedVerticesAndJoinsTheRestToAllOfThem) {
  const PoseGraph truth = random_graph(3, 20, 10, 0.0, 1);
  PoseGraph graph = truth;
  graph.vertices[4].fixed = graph.vertices[15].fixed = true;
  scatter(graph, 1);
  graph.vertices[0].world_from_frame = test::shift(100.0, 0.0, 0.0);
  const PoseGraph before = graph;
  initialize_chordal(graph);
  for (const std::size_t v : {4u, 15u}) {
    EXPECT_EQ(graph.vertices[v].world_from_frame.translation, before.vertices[v].world_from_frame.translation);
    EXPECT_EQ(graph.vertices[v].world_from_frame.rotation.coeffs(), before.vertices[v].world_from_frame.rotation.coeffs());
  }
  EXPECT_LT(largest_distance(graph, truth), kRelaxationRounding);
}

TEST(Initialization, EachComponentHangsOnItsOwnAnchor) {
  PoseGraph truth = random_graph(3, 20, 10, 0.0, 1);
  const PoseGraph other = random_graph(3, 10, 5, 0.0, 2);
  for (Vertex vertex : other.vertices) truth.vertices.push_back({vertex.id + 100, vertex.world_from_frame, false});
  for (Edge edge : other.edges) {
    edge.from += 20;
    edge.to += 20;
    truth.edges.push_back(edge);
  }
  truth.vertices.push_back({1000, test::shift(1, 2, 3), false});
  PoseGraph graph = truth;
  for (std::size_t v = 1; v < 20; ++v) graph.vertices[v].world_from_frame = {};
  initialize_chordal(graph);
  EXPECT_LT(largest_distance(graph, truth), kRelaxationRounding);
}

TEST(Initialization, EdgesWithoutInformationStillSayWhereToStart) {
  const PoseGraph truth = random_graph(3, 10, 0, 0.0, 1);
  PoseGraph graph = truth;
  graph.edges[4].information.setZero();
  scatter(graph, 1);
  initialize_chordal(graph);
  // Weights 1e9 apart cost nine of the sixteen digits.
  EXPECT_LT(largest_distance(graph, truth), 1e-5);
  for (Edge& edge : graph.edges) edge.information.setZero();
  scatter(graph, 1);
  initialize_chordal(graph);
  EXPECT_LT(largest_distance(graph, truth), kRelaxationRounding);
}

TEST(Initialization, EdgesWithoutScaleTurnVerticesAndHardlyMoveThem) {
  const PoseGraph truth = random_graph(3, 20, 10, 0.0, 1);
  PoseGraph graph = truth;
  for (Edge& edge : graph.edges) {
    if (edge.kind != EdgeKind::Loop) continue;
    edge.has_scale = false;
    edge.from_from_to.translation = Eigen::Vector3d::UnitX();
  }
  scatter(graph, 1);
  initialize_chordal(graph);
  // Weights 1e9 apart, wrong by the size of the map.
  EXPECT_LT(largest_distance(graph, truth), 1e-5);
  EXPECT_LT(largest_angle(graph, truth), kRelaxationRounding);
}

TEST(Initialization, ScatteredGraphsReachTheOptimumThatTheTruthLeadsTo) {
  for (const int dimension : {2, 3}) {
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
      PoseGraph from_truth = random_graph(dimension, 40, 40, 0.1, seed);
      PoseGraph from_nothing = from_truth;
      scatter(from_nothing, seed);
      OptimizeOptions options;
      const double optimum = optimize(from_truth, options).final_cost;
      for (const Initialization initialization : {Initialization::Chordal, Initialization::LowestCost}) {
        PoseGraph graph = from_nothing;
        options.initialization = initialization;
        const OptimizeReport report = optimize(graph, options);
        EXPECT_EQ(report.start, Initialization::Chordal);
        EXPECT_EQ(report.termination, Termination::Converged);
        EXPECT_NEAR(report.final_cost, optimum, 10.0 * options.cost_tolerance * optimum);
      }
    }
  }
}

TEST(Initialization, LowestCostKeepsPosesThatFit) {
  PoseGraph graph = random_graph(3, 40, 40, 0.1, 1);
  optimize(graph);
  const OptimizeReport report = optimize(graph, {.initialization = Initialization::LowestCost});
  EXPECT_EQ(report.start, Initialization::AsGiven);
  EXPECT_LE(report.iterations, 2);
}

TEST(Initialization, ASpanningTreeStartsFromTheEdgesAlone) {
  const PoseGraph truth = random_graph(3, 20, 10, 0.0, 1);
  PoseGraph graph = truth;
  scatter(graph, 1);
  const OptimizeReport report = optimize(graph, {.initialization = Initialization::SpanningTree});
  EXPECT_EQ(report.start, Initialization::SpanningTree);
  EXPECT_LT(largest_distance(graph, truth), 1e-6);
}

TEST(Initialization, RefusesABrokenGraph) {
  PoseGraph graph = random_graph(3, 5, 0, 0.0, 1);
  graph.edges[0].to = 9;
  EXPECT_THROW(initialize_chordal(graph), InputError);
}

}  // namespace
}  // namespace fabloop
