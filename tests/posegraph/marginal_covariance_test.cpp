// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/marginal_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "frontend/error.h"
#include "tests/posegraph/synthetic_graph.h"
#include "verification/chi_square.h"
#include "verification/uncertain_pose.h"

namespace fabloop {
namespace {

OptimizeOptions likelihood() {
  OptimizeOptions options;
  options.objective = Objective::RotationVector;
  return options;
}

test::CircleOptions noisy(std::uint32_t seed, int dimension = 3) {
  test::CircleOptions options;
  options.num_vertices = 20;
  options.sigma_translation_m = 0.02;
  options.sigma_rotation_rad = 0.005;
  options.seed = seed;
  options.dimension = dimension;
  return options;
}

TEST(MarginalCovariance, OfAChainIsTheProductOfItsSteps) {
  PoseGraph graph = test::make_circle(noisy(1)).graph;
  graph.edges.resize(graph.vertices.size() - 1);
  UncertainPose chain;
  for (const Edge& edge : graph.edges) {
    chain = chain * UncertainPose{edge.from_from_to, edge.information.inverse()};
    const Eigen::MatrixXd covariance = marginal_covariance(graph, {edge.to}, likelihood());
    EXPECT_LT((covariance - chain.covariance).norm(), 1e-6 * chain.covariance.norm());
  }
}

TEST(MarginalCovariance, IsHonest) {
  // Over many graphs the squared error of a pose, in units of its covariance, is chi-square: its mean is the number of axes.
  for (const int dimension : {2, 3}) {
    constexpr int kGraphs = 60;
    double sum = 0.0;
    for (std::uint32_t seed = 0; seed < kGraphs; ++seed) {
      const test::Circle circle = test::make_circle(noisy(seed, dimension));
      PoseGraph graph = circle.graph;
      optimize(graph, likelihood());
      constexpr std::size_t kVertex = 13;
      const Eigen::MatrixXd covariance = marginal_covariance(graph, {kVertex}, likelihood());
      const Eigen::VectorXd error =
          pose_error(graph.vertices[kVertex].world_from_frame, circle.truth.vertices[kVertex].world_from_frame);
      // Zeros of the plane have no error either.
      const Eigen::MatrixXd inverse = covariance.completeOrthogonalDecomposition().pseudoInverse();
      sum += error.dot(inverse * error);
    }
    const double mean = sum / kGraphs;
    const double axes = dimension == 2 ? 3.0 : 6.0;
    // Four standard deviations of the mean of that many.
    EXPECT_NEAR(mean, axes, 4.0 * std::sqrt(2.0 * axes / kGraphs));
  }
}

TEST(MarginalCovariance, LoopsMakePosesSurer) {
  PoseGraph graph = test::make_circle(noisy(2)).graph;
  PoseGraph chain = graph;
  chain.edges.resize(chain.vertices.size() - 1);
  const std::size_t last = graph.vertices.size() - 1;
  const Eigen::MatrixXd difference =
      marginal_covariance(chain, {last}, likelihood()) - marginal_covariance(graph, {last}, likelihood());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(difference).eigenvalues().minCoeff(), -1e-12);
  EXPECT_GT(difference.trace(), 0.0);
}

TEST(MarginalCovariance, OfSeveralIsSymmetricAndHoldsThatOfEach) {
  const PoseGraph graph = test::make_circle(noisy(3)).graph;
  const Eigen::MatrixXd joint = marginal_covariance(graph, {4, 0, 11}, likelihood());
  ASSERT_EQ(joint.rows(), 18);
  EXPECT_LT((joint - joint.transpose()).norm(), 1e-9 * joint.norm());
  EXPECT_LT((joint.topLeftCorner<6, 6>() - marginal_covariance(graph, {4}, likelihood())).norm(), 1e-12);
  EXPECT_EQ(joint.middleRows(6, 6).norm(), 0.0) << "the first vertex is held";
  EXPECT_GT(joint.block(0, 12, 6, 6).norm(), 0.0);
}

TEST(MarginalCovariance, RefusesWhatHasNone) {
  PoseGraph graph = test::make_circle(noisy(4)).graph;
  EXPECT_THROW(marginal_covariance(graph, {graph.vertices.size()}), InputError);
  for (Edge& edge : graph.edges) {
    edge.has_scale = false;
    edge.from_from_to.translation.normalize();
  }
  graph.edges.resize(graph.vertices.size() - 1);
  EXPECT_THROW(marginal_covariance(graph, {3}, likelihood()), InputError);
}

}  // namespace
}  // namespace fabloop
