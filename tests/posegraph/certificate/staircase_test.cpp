// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/certificate/staircase.h"

#include <gtest/gtest.h>

#include "frontend/error.h"
#include "tests/posegraph/random_graph.h"

namespace fabloop {
namespace {

using test::random_graph;
using test::wound_ring;

GlobalOptions from_given() {
  GlobalOptions options;
  options.optimize.initialization = Initialization::AsGiven;
  return options;
}

TEST(Staircase, ClimbsOutOfALocalMinimum) {
  for (const int dimension : {2, 3}) {
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
      PoseGraph graph = wound_ring(dimension, 15, 0.02, seed);
      PoseGraph best = graph;
      const double optimum = optimize(best, {.initialization = Initialization::Chordal}).final_cost;
      const GlobalReport report = optimize_globally(graph, from_given());
      EXPECT_GE(report.num_extra_dimensions, 1);
      EXPECT_TRUE(report.certificate.is_global) << report.certificate.brief();
      EXPECT_NEAR(report.optimize.final_cost, optimum, 1e-6 * optimum);
      EXPECT_NEAR(evaluate_cost(graph), report.optimize.final_cost, 1e-9 * optimum);
      EXPECT_EQ(graph.vertices[0].world_from_frame.translation, Eigen::Vector3d::Zero()) << "the anchor";
    }
  }
}

TEST(Staircase, KeepsAFixedVertexWhereItIs) {
  PoseGraph graph = wound_ring(3, 15, 0.02, 1);
  graph.vertices[4].fixed = true;
  graph.vertices[4].world_from_frame.translation = {1.0, 2.0, 3.0};
  const Pose before = graph.vertices[4].world_from_frame;
  const GlobalReport report = optimize_globally(graph, from_given());
  EXPECT_TRUE(report.certificate.is_global) << report.certificate.brief();
  EXPECT_EQ(graph.vertices[4].world_from_frame.translation, before.translation);
  EXPECT_EQ(graph.vertices[4].world_from_frame.rotation.coeffs(), before.rotation.coeffs());
}

TEST(Staircase, IsNotNeededWhereTheFirstSolutionIsCertified) {
  PoseGraph graph = random_graph(3, 30, 30, 0.1, 1);
  PoseGraph plain = graph;
  const GlobalReport report = optimize_globally(graph, from_given());
  EXPECT_EQ(report.num_extra_dimensions, 0);
  EXPECT_TRUE(report.certificate.is_global);
  EXPECT_EQ(report.optimize.final_cost, optimize(plain).final_cost);
}

TEST(Staircase, NeverEndsHigherThanTheFirstSolution) {
  // Noise as large as the measurements: the relaxation need not be tight.
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    PoseGraph graph = random_graph(3, 6, 6, 1.5, seed);
    PoseGraph plain = graph;
    const double cost = optimize(plain).final_cost;
    GlobalOptions options = from_given();
    options.max_extra_dimensions = 2;
    const GlobalReport report = optimize_globally(graph, options);
    EXPECT_LE(report.optimize.final_cost, cost * (1.0 + 1e-12));
    EXPECT_LE(report.certificate.lower_bound, report.optimize.final_cost * (1.0 + 1e-9));
  }
}

TEST(Staircase, RefusesWhatHasNoCertificate) {
  PoseGraph graph = random_graph(3, 10, 5, 0.1, 1);
  GlobalOptions options;
  options.optimize.objective = Objective::RotationVector;
  EXPECT_THROW(optimize_globally(graph, options), InputError);
  options.optimize.objective = Objective::Chordal;
  options.optimize.robust_loss = RobustLoss::Cauchy;
  EXPECT_THROW(optimize_globally(graph, options), InputError);
}

}  // namespace
}  // namespace fabloop
