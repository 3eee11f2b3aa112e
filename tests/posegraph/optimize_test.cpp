// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/optimize.h"

#include <gtest/gtest.h>

#include "frontend/error.h"
#include "tests/posegraph/objectives.h"
#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

using test::Circle;
using test::CircleOptions;
using test::largest_angle;
using test::largest_distance;
using test::make_circle;
using test::rotation_from_vector;
using test::shift;

using test::kObjectives;

/// Sums of a few dozen squares of differences of numbers near 10.
constexpr double kRounding = 1e-18;

/// A solver that stops when the cost no longer falls leaves the poses this close to the optimum.
constexpr double kSolverError = 1e-6;

OptimizeOptions with(Objective objective, RobustLoss loss = RobustLoss::None) {
  OptimizeOptions options;
  options.objective = objective;
  options.robust_loss = loss;
  return options;
}

/// Two vertices and one edge, whose second vertex is off by `error` in its own frame.
PoseGraph off_by(const Pose& error, const Matrix6d& information) {
  PoseGraph graph;
  const Pose i_from_j{rotation_from_vector({0.3, -0.2, 0.5}), {1.0, 2.0, -0.5}};
  const Pose world_from_i{rotation_from_vector({-0.4, 0.1, 0.7}), {5.0, -3.0, 2.0}};
  graph.vertices = {{0, world_from_i, false}, {1, world_from_i * i_from_j * error, false}};
  graph.edges.resize(1);
  graph.edges[0].to = 1;
  graph.edges[0].from_from_to = i_from_j;
  graph.edges[0].information = information;
  return graph;
}

TEST(Optimize, CostIsZeroAtTheTruth) {
  for (const int dimension : {2, 3}) {
    for (const Objective objective : kObjectives) {
      CircleOptions options;
      options.dimension = dimension;
      EXPECT_LT(evaluate_cost(make_circle(options).truth, with(objective)), kRounding * 1e6) << dimension;
    }
  }
}

TEST(Optimize, CostsAreTheFormulasOfEachObjective) {
  const double angle = 0.2;
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();
  const Eigen::Vector3d offset(0.1, -0.3, 0.2);
  Matrix6d information = Matrix6d::Zero();
  information.diagonal() << 1.0, 2.0, 4.0, 10.0, 20.0, 40.0;
  information(0, 5) = information(5, 0) = 0.7;
  const PoseGraph graph = off_by({Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), offset}, information);

  Eigen::Matrix<double, 6, 1> error;
  error << offset, angle * axis;
  EXPECT_NEAR(evaluate_cost(graph, with(Objective::RotationVector)), error.dot(information * error), 1e-12);
  error.tail<3>() = 2.0 * std::sin(0.5 * angle) * axis;
  EXPECT_NEAR(evaluate_cost(graph, with(Objective::Quaternion)), error.dot(information * error), 1e-12);
  const double tau = 3.0 / (1.0 + 0.5 + 0.25);
  const double kappa = 3.0 / (2.0 * (0.1 + 0.05 + 0.025));
  const double squared_chord = 8.0 * std::pow(std::sin(0.5 * angle), 2);
  EXPECT_NEAR(evaluate_cost(graph, with(Objective::Chordal)), kappa * squared_chord + tau * offset.squaredNorm(), 1e-12);
}

TEST(Optimize, PlanarCostsAreTheSpatialOnesInThePlane) {
  CircleOptions options;
  options.dimension = 2;
  options.sigma_translation_m = 0.1;
  options.sigma_rotation_rad = 0.1;
  PoseGraph planar = make_circle(options).graph;
  PoseGraph spatial = planar;
  spatial.dimension = 3;
  for (const Objective objective : {Objective::RotationVector, Objective::Quaternion}) {
    const double cost = evaluate_cost(planar, with(objective));
    EXPECT_NEAR(evaluate_cost(spatial, with(objective)), cost, 1e-9 * cost);
  }
}

TEST(Optimize, EveryObjectiveRecoversANoiseFreeCircleFromAPerturbedStart) {
  for (const int dimension : {2, 3}) {
    CircleOptions options;
    options.dimension = dimension;
    const Circle circle = make_circle(options);
    for (const Objective objective : kObjectives) {
      PoseGraph graph = circle.truth;
      for (std::size_t v = 1; v < graph.vertices.size(); ++v) {
        const double sign = v % 2 == 0 ? 1.0 : -1.0;
        const Eigen::Vector3d turn = dimension == 2 ? Eigen::Vector3d(0, 0, 0.2) : Eigen::Vector3d(0.1, -0.2, 0.15);
        const Eigen::Vector3d shift(0.5, -0.7, dimension == 2 ? 0.0 : 0.6);
        Pose& pose = graph.vertices[v].world_from_frame;
        pose = pose * Pose{rotation_from_vector(sign * turn), sign * shift};
      }
      const OptimizeReport report = optimize(graph, with(objective));
      EXPECT_EQ(report.termination, Termination::Converged) << report.full();
      EXPECT_LT(largest_distance(graph, circle.truth), kSolverError);
      EXPECT_LT(largest_angle(graph, circle.truth), kSolverError);
    }
  }
}

TEST(Optimize, EveryObjectiveBringsANoisyCircleNearerToTheTruth) {
  CircleOptions options;
  options.sigma_translation_m = 0.05;
  options.sigma_rotation_rad = 0.02;
  const Circle circle = make_circle(options);
  const double before_m = largest_distance(circle.graph, circle.truth);
  for (const Objective objective : kObjectives) {
    PoseGraph graph = circle.graph;
    const OptimizeReport report = optimize(graph, with(objective));
    EXPECT_EQ(report.termination, Termination::Converged);
    EXPECT_LT(report.final_cost, 0.2 * report.initial_cost);
    EXPECT_LT(largest_distance(graph, circle.truth), 0.6 * before_m);
    EXPECT_NEAR(evaluate_cost(graph, with(objective)), report.final_cost, 1e-9 * report.final_cost);
  }
}

TEST(Optimize, TheSameInputGivesTheSameBits) {
  CircleOptions options;
  options.sigma_translation_m = 0.05;
  options.sigma_rotation_rad = 0.02;
  PoseGraph first = make_circle(options).graph;
  PoseGraph second = first;
  optimize(first);
  optimize(second);
  for (std::size_t v = 0; v < first.vertices.size(); ++v) {
    EXPECT_EQ(first.vertices[v].world_from_frame.translation, second.vertices[v].world_from_frame.translation);
    EXPECT_EQ(first.vertices[v].world_from_frame.rotation.coeffs(), second.vertices[v].world_from_frame.rotation.coeffs());
  }
}

TEST(Optimize, FixedVerticesStayAndAnchorTheRest) {
  CircleOptions options;
  options.sigma_translation_m = 0.05;
  options.sigma_rotation_rad = 0.02;
  PoseGraph graph = make_circle(options).graph;
  graph.vertices[7].fixed = true;
  const Pose before = graph.vertices[7].world_from_frame;
  const Pose first_before = graph.vertices[0].world_from_frame;
  const OptimizeReport report = optimize(graph);
  EXPECT_EQ(report.anchors, std::vector<std::size_t>{7});
  EXPECT_EQ(graph.vertices[7].world_from_frame.translation, before.translation);
  EXPECT_EQ(graph.vertices[7].world_from_frame.rotation.coeffs(), before.rotation.coeffs());
  EXPECT_NE(graph.vertices[0].world_from_frame.translation, first_before.translation);
}

TEST(Optimize, EachComponentKeepsItsOwnPlace) {
  PoseGraph graph = make_circle().truth;
  const PoseGraph other = graph;
  const std::size_t offset = graph.vertices.size();
  for (Vertex vertex : other.vertices) {
    vertex.id += 1000;
    vertex.world_from_frame.translation.x() += 500.0;
    graph.vertices.push_back(vertex);
  }
  for (Edge edge : other.edges) {
    edge.from += offset;
    edge.to += offset;
    graph.edges.push_back(edge);
  }
  const PoseGraph truth = graph;
  graph.vertices[offset + 5].world_from_frame.translation.y() += 1.0;
  const OptimizeReport report = optimize(graph);
  EXPECT_EQ(report.num_components, 2u);
  EXPECT_EQ(report.anchors, (std::vector<std::size_t>{0, offset}));
  EXPECT_LT(largest_distance(graph, truth), kSolverError);
  EXPECT_NE(report.full().find("components"), std::string::npos);
}

TEST(Optimize, ARobustLossResistsAFalseLoopThatComesIn) {
  CircleOptions options;
  options.sigma_translation_m = 0.02;
  options.sigma_rotation_rad = 0.01;
  Circle circle = make_circle(options);
  // A map is corrected as it grows: what comes in meets poses that agree with the loops before it.
  optimize(circle.graph);
  const PoseGraph without = circle.graph;
  Edge false_loop = circle.truth.edges.back();
  false_loop.from = 3;
  false_loop.to = 14;
  circle.graph.edges.push_back(false_loop);
  PoseGraph believed = circle.graph;
  optimize(believed);
  EXPECT_GT(largest_distance(believed, without), 1.0);
  for (const Objective objective : kObjectives) {
    for (const RobustLoss loss : {RobustLoss::Cauchy, RobustLoss::GemanMcClure}) {
      PoseGraph graph = circle.graph;
      const OptimizeReport report = optimize(graph, with(objective, loss));
      // A few standard deviations of a step.
      EXPECT_LT(largest_distance(graph, without), 0.1) << report.full();
      EXPECT_LT(report.edges.back().weight, 0.01);
      EXPECT_GT(report.edges[report.edges.size() - 2].weight, 0.4);
      EXPECT_DOUBLE_EQ(report.edges.front().weight, 1.0) << "odometry has no robust loss by default";
    }
  }
}

TEST(Optimize, ADirectionFixesTheHeadingAndLeavesTheScale) {
  for (const Objective objective : kObjectives) {
    PoseGraph graph = off_by({}, Matrix6d::Identity());
    const Pose truth = graph.vertices[1].world_from_frame;
    const Pose i = graph.vertices[0].world_from_frame;
    graph.edges[0].has_scale = false;
    graph.edges[0].from_from_to.translation.normalize();
    EXPECT_LT(evaluate_cost(graph, with(objective)), 1e-15);

    // Further along the same direction costs nothing.
    graph.vertices[1].world_from_frame.translation = i.translation + 3.0 * (truth.translation - i.translation);
    EXPECT_LT(evaluate_cost(graph, with(objective)), 1e-15);

    // The opposite direction is worst: 2 sin(180 deg / 2) squared, the guard near it apart.
    graph.vertices[1].world_from_frame.translation =
        i.translation - (truth.translation - i.translation) + Eigen::Vector3d(0.05, 0, 0);
    EXPECT_GT(evaluate_cost(graph, with(objective)), 3.5);

    graph.vertices[1].world_from_frame =
        Pose{rotation_from_vector({0.1, 0, 0.1}), truth.translation + Eigen::Vector3d(0.5, -0.4, 0.3)};
    const double length = (graph.vertices[1].world_from_frame.translation - i.translation).norm();
    const OptimizeReport report = optimize(graph, with(objective));
    EXPECT_LT(report.final_cost, 1e-12);
    EXPECT_EQ(report.num_components_without_scale, 1u);
    const Eigen::Vector3d moved = graph.vertices[1].world_from_frame.translation - i.translation;
    EXPECT_LT((moved.normalized() - (truth.translation - i.translation).normalized()).norm(), kSolverError);
    EXPECT_NEAR(moved.norm(), length, 0.2 * length) << "its size stays near what it was";
  }
}

TEST(Optimize, DirectionsAreMetWhereTheChainHasTheScale) {
  CircleOptions options;
  options.sigma_translation_m = 0.05;
  options.sigma_rotation_rad = 0.02;
  Circle circle = make_circle(options);
  for (Edge& edge : circle.graph.edges) {
    if (edge.kind != EdgeKind::Loop) continue;
    edge.has_scale = false;
    edge.from_from_to = test::measured_edge(circle.truth, edge.from, edge.to, edge.kind).from_from_to;
    edge.from_from_to.translation.normalize();
    edge.information.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() * 1e4;
  }
  // Three standard deviations of a direction weighed by 1e4.
  constexpr double kMaxDirectionError = 0.03;
  for (const Objective objective : kObjectives) {
    PoseGraph graph = circle.graph;
    const OptimizeReport report = optimize(graph, with(objective));
    EXPECT_EQ(report.num_components_without_scale, 0u);
    EXPECT_LT(largest_distance(graph, circle.truth), largest_distance(circle.graph, circle.truth)) << report.full();
    for (const Edge& edge : graph.edges) {
      if (edge.has_scale) continue;
      const Pose i_from_j = graph.vertices[edge.from].world_from_frame.inverse() * graph.vertices[edge.to].world_from_frame;
      EXPECT_LT((i_from_j.translation.normalized() - edge.from_from_to.translation).norm(), kMaxDirectionError);
    }
  }
}

TEST(Optimize, ReportsProgressAndStopsWhenAsked) {
  CircleOptions options;
  options.sigma_translation_m = 0.05;
  options.sigma_rotation_rad = 0.02;
  PoseGraph graph = make_circle(options).graph;
  OptimizeOptions optimize_options;
  int calls = 0;
  optimize_options.progress = [&](std::string_view stage, std::size_t, std::size_t total) {
    EXPECT_EQ(stage, "optimize");
    EXPECT_EQ(total, 200u);
    ++calls;
  };
  optimize_options.cancelled = [&] { return calls >= 2; };
  const OptimizeReport report = optimize(graph, optimize_options);
  EXPECT_EQ(report.termination, Termination::Cancelled);
  EXPECT_EQ(calls, 2);
  EXPECT_LT(report.final_cost, report.initial_cost);
}

TEST(Optimize, SaysThatItRanOutOfIterations) {
  CircleOptions options;
  options.sigma_translation_m = 0.05;
  options.sigma_rotation_rad = 0.02;
  PoseGraph graph = make_circle(options).graph;
  OptimizeOptions optimize_options;
  optimize_options.max_iterations = 1;
  const OptimizeReport report = optimize(graph, optimize_options);
  EXPECT_EQ(report.termination, Termination::MaxIterations);
  EXPECT_NE(report.brief().find("maximum number of iterations"), std::string::npos);
}

TEST(Optimize, WithoutEdgesOrFreeVerticesThereIsNothingToDo) {
  PoseGraph empty;
  EXPECT_EQ(optimize(empty).termination, Termination::NothingToDo);
  PoseGraph fixed = off_by(shift(0.1, 0, 0), Matrix6d::Identity());
  for (Vertex& vertex : fixed.vertices) vertex.fixed = true;
  const OptimizeReport report = optimize(fixed);
  EXPECT_EQ(report.termination, Termination::NothingToDo);
  EXPECT_NEAR(report.final_cost, 0.01, 1e-12);
}

TEST(Optimize, IndefiniteInformationIsMendedAndCounted) {
  PoseGraph graph = off_by(shift(0.1, 0, 0), Matrix6d::Identity());
  graph.edges[0].information(0, 3) = graph.edges[0].information(3, 0) = 2.0;
  const OptimizeReport report = optimize(graph, with(Objective::RotationVector));
  EXPECT_EQ(report.num_mended_information, 1u);
  EXPECT_LT(report.final_cost, 1e-12);
}

TEST(Optimize, RefusesGraphsThatAreBroken) {
  const PoseGraph good = off_by({}, Matrix6d::Identity());
  const auto expect_refused = [](PoseGraph graph, const char* why) { EXPECT_THROW(optimize(graph), InputError) << why; };
  PoseGraph graph = good;
  graph.edges[0].to = 2;
  expect_refused(graph, "no such vertex");
  graph = good;
  graph.edges[0].to = 0;
  expect_refused(graph, "edge to itself");
  graph = good;
  graph.edges[0].information(1, 1) = std::nan("");
  expect_refused(graph, "information not finite");
  graph = good;
  graph.vertices[1].world_from_frame.translation.x() = std::nan("");
  expect_refused(graph, "pose not finite");
  graph = good;
  graph.dimension = 2;
  graph.edges[0].has_scale = false;
  expect_refused(graph, "planar direction");
  graph = good;
  graph.edges[0].has_scale = false;
  graph.edges[0].from_from_to.translation.setZero();
  expect_refused(graph, "direction of length zero");
}

}  // namespace
}  // namespace fabloop
