// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "frontend/error.h"
#include "posegraph/optimize.h"
#include "posegraph/residuals/residuals.h"
#include "posegraph/residuals/yaw_manifold.h"
#include "tests/posegraph/numeric_derivatives.h"
#include "tests/posegraph/random_graph.h"
#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

using test::largest_angle;
using test::largest_distance;
using test::random_graph;

/// A solver that stops when the cost no longer falls leaves the poses this close to the optimum.
constexpr double kPriorSolverError = 1e-5;

void add_prior(PoseGraph& graph, std::size_t vertex, PriorKind kind) {
  graph.priors.push_back({vertex, kind, graph.vertices[vertex].world_from_frame, Matrix6d::Identity()});
}

/// The whole map turned and moved away from where its priors are.
void displace(PoseGraph& graph, const Eigen::Vector3d& turn) {
  const Pose motion{rotation_from_vector(turn), {30.0, -20.0, 0.0}};
  for (Vertex& vertex : graph.vertices) vertex.world_from_frame = motion * vertex.world_from_frame;
}

TEST(Priors, DerivativesOfAttitudesAreThoseOfDifferences) {
  test::RandomPoses random(1);
  for (int trial = 0; trial < 20; ++trial) {
    VertexPrior prior;
    prior.kind = PriorKind::Attitude;
    prior.world_from_frame = random.pose(1.0);
    prior.information = random.information();
    const Eigen::Quaterniond q = random.pose(1.0).rotation;
    const test::Blocks blocks = {{q.x(), q.y(), q.z(), q.w()}};
    test::expect_derivatives(*residuals::make_residual(prior, 3, Objective::Chordal), blocks);
  }
}

TEST(Priors, AttitudesWeighSmallTurnsAboutTheAxesOfTheVertex) {
  test::RandomPoses random(2);
  for (int trial = 0; trial < 20; ++trial) {
    VertexPrior prior;
    prior.kind = PriorKind::Attitude;
    prior.world_from_frame = random.pose(1.0);
    prior.information = random.information();
    const Eigen::Vector3d up = prior.world_from_frame.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    Eigen::Vector3d turn = 1e-5 * random.vector();
    turn -= up * up.dot(turn);
    PoseGraph graph;
    graph.vertices.push_back({0, prior.world_from_frame * Pose{rotation_from_vector(turn), Eigen::Vector3d::Zero()}, false});
    graph.priors.push_back(prior);
    const double expected = turn.dot(prior.information.bottomRightCorner<3, 3>() * turn);
    EXPECT_NEAR(evaluate_cost(graph), expected, 1e-4 * expected) << "of the order of the turn";
    // About the vertical it may turn.
    const Pose yaw{rotation_from_vector({0.0, 0.0, 2.0}), Eigen::Vector3d::Zero()};
    graph.vertices[0].world_from_frame = yaw * prior.world_from_frame;
    EXPECT_LT(evaluate_cost(graph), 1e-20);
  }
}

TEST(Priors, PositionsPutAMapWhereTheyAre) {
  for (const int dimension : {2, 3}) {
    for (const Initialization start : {Initialization::AsGiven, Initialization::Chordal}) {
      const PoseGraph truth = random_graph(dimension, 20, 10, 0.0, 1);
      PoseGraph graph = truth;
      for (const std::size_t v : {1u, 6u, 12u, 18u}) add_prior(graph, v, PriorKind::Position);
      displace(graph, {0.0, 0.0, 0.5});
      const OptimizeReport report = optimize(graph, {.initialization = start});
      EXPECT_TRUE(report.anchors.empty());
      EXPECT_EQ(report.priors.size(), 4u);
      EXPECT_LT(largest_distance(graph, truth), kPriorSolverError) << report.full();
      EXPECT_LT(largest_angle(graph, truth), kPriorSolverError);
    }
  }
}

TEST(Priors, OnePoseIsEnough) {
  for (const int dimension : {2, 3}) {
    const PoseGraph truth = random_graph(dimension, 20, 10, 0.0, 1);
    PoseGraph graph = truth;
    add_prior(graph, 7, PriorKind::Pose);
    displace(graph, {0.0, 0.0, 0.5});
    optimize(graph, {.initialization = Initialization::LowestCost});
    EXPECT_LT(largest_distance(graph, truth), kPriorSolverError);
    EXPECT_LT(largest_angle(graph, truth), kPriorSolverError);
  }
}

TEST(Priors, AltitudesAndAttitudesLevelAMapAndLeaveTheRest) {
  const PoseGraph truth = random_graph(3, 20, 10, 0.0, 1);
  PoseGraph graph = truth;
  for (std::size_t v = 0; v < 20; v += 3) {
    add_prior(graph, v, PriorKind::Attitude);
    add_prior(graph, v, PriorKind::Position);
    graph.priors.back().information.setZero();
    graph.priors.back().information(2, 2) = 1.0;
    graph.priors.back().world_from_frame.translation.head<2>().setConstant(1e3);
  }
  displace(graph, {0.2, -0.1, 0.0});
  const OptimizeReport report = optimize(graph);
  EXPECT_LT(report.final_cost, 1e-8) << report.full();
  for (std::size_t v = 0; v < 20; ++v) {
    const Pose& pose = graph.vertices[v].world_from_frame;
    const Pose& true_pose = truth.vertices[v].world_from_frame;
    EXPECT_NEAR(pose.translation.z(), true_pose.translation.z(), 1e-3);
    const Eigen::Vector3d up = pose.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    EXPECT_LT((up - true_pose.rotation.conjugate() * Eigen::Vector3d::UnitZ()).norm(), 1e-4);
  }
}

TEST(Priors, AFixedVertexIsHeldBesidePriors) {
  PoseGraph graph = random_graph(3, 10, 5, 0.0, 1);
  graph.vertices[3].fixed = true;
  const Pose before = graph.vertices[3].world_from_frame;
  add_prior(graph, 5, PriorKind::Position);
  graph.priors.back().world_from_frame.translation.x() += 1.0;
  const OptimizeReport report = optimize(graph);
  EXPECT_EQ(report.anchors, std::vector<std::size_t>{3});
  EXPECT_EQ(graph.vertices[3].world_from_frame.translation, before.translation);
  EXPECT_GT(report.priors[0].chi2, 0.0);
}

TEST(Priors, BrokenOnesAreRefused) {
  PoseGraph graph = random_graph(3, 5, 0, 0.0, 1);
  add_prior(graph, 2, PriorKind::Pose);
  graph.priors[0].vertex = 5;
  EXPECT_THROW(optimize(graph), InputError);
  graph.priors[0].vertex = 2;
  graph.priors[0].information(0, 0) = std::nan("");
  EXPECT_THROW(optimize(graph), InputError);
  PoseGraph planar = random_graph(2, 5, 0, 0.0, 1);
  add_prior(planar, 2, PriorKind::Attitude);
  EXPECT_THROW(optimize(planar), InputError);
}

TEST(Freedom, FourDegreesKeepRollAndPitch) {
  PoseGraph graph = random_graph(3, 20, 20, 0.05, 1);
  const PoseGraph truth = graph;
  test::RandomPoses random(7);
  for (std::size_t v = 1; v < graph.vertices.size(); ++v) {
    Pose& pose = graph.vertices[v].world_from_frame;
    pose.rotation = rotation_from_vector({0.0, 0.0, 0.3 * random.number()}) * pose.rotation;
    pose.translation += random.vector();
  }
  const OptimizeReport report = optimize(graph, {.freedom = Freedom::YawAndPosition});
  EXPECT_EQ(report.termination, Termination::Converged);
  EXPECT_LT(report.final_cost, 0.1 * report.initial_cost);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    const Eigen::Vector3d up = graph.vertices[v].world_from_frame.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    EXPECT_LT((up - truth.vertices[v].world_from_frame.rotation.conjugate() * Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  }
  EXPECT_LT(largest_angle(graph, truth), 0.15) << "three standard deviations";
  EXPECT_THROW(optimize(graph, {.initialization = Initialization::Chordal, .freedom = Freedom::YawAndPosition}), InputError);
}

TEST(Freedom, YawStepsBeginAlongTheirDerivative) {
  test::RandomPoses random(3);
  const residuals::YawManifold manifold;
  const Eigen::Quaterniond q = random.pose(1.0).rotation;
  Eigen::Vector4d ahead;
  Eigen::Vector4d behind;
  Eigen::Vector4d derivative;
  const double step = test::kStep;
  const double back = -step;
  ASSERT_TRUE(manifold.Plus(q.coeffs().data(), &step, ahead.data()));
  ASSERT_TRUE(manifold.Plus(q.coeffs().data(), &back, behind.data()));
  ASSERT_TRUE(manifold.PlusJacobian(q.coeffs().data(), derivative.data()));
  EXPECT_LT(((ahead - behind) / (2.0 * step) - derivative).norm(), test::kDifferenceError);
}

}  // namespace
}  // namespace fabloop
