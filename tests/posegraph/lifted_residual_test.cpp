// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/residuals/lifted_residual.h"

#include <gtest/gtest.h>

#include "posegraph/optimize.h"
#include "posegraph/residuals/stiefel_manifold.h"
#include "tests/posegraph/numeric_derivatives.h"
#include "tests/posegraph/random_graph.h"

namespace fabloop {
namespace {

using residuals::LiftedResidual;
using residuals::StiefelManifold;

std::vector<double> numbers(const Eigen::MatrixXd& matrix) { return {matrix.data(), matrix.data() + matrix.size()}; }

Eigen::MatrixXd random_matrix(test::RandomPoses& random, int rows, int columns) {
  Eigen::MatrixXd matrix(rows, columns);
  for (double& entry : matrix.reshaped()) entry = random.number();
  return matrix;
}

TEST(LiftedResidual, DerivativesAreThoseOfDifferences) {
  test::RandomPoses random(1);
  for (const int d : {2, 3}) {
    for (int r = d; r <= d + 2; ++r) {
      Edge edge;
      edge.from_from_to = d == 2 ? random.planar_pose(2.0) : random.pose(2.0);
      edge.information = random.information();
      const test::Blocks blocks = {numbers(random_matrix(random, r, d)), numbers(random_matrix(random, r, 1)),
                                   numbers(random_matrix(random, r, d)), numbers(random_matrix(random, r, 1))};
      test::expect_derivatives(LiftedResidual(edge, d, r), blocks);
    }
  }
}

TEST(LiftedResidual, CostsWhatTheChordalObjectiveCosts) {
  for (const int d : {2, 3}) {
    PoseGraph graph = test::random_graph(d, 2, 0, 0.5, 3);
    const Edge& edge = graph.edges[0];
    test::Blocks blocks;
    for (const std::size_t v : {edge.from, edge.to}) {
      const Pose& pose = graph.vertices[v].world_from_frame;
      blocks.push_back(numbers(pose.rotation.toRotationMatrix().topLeftCorner(d, d)));
      blocks.push_back(numbers(pose.translation.head(d)));
    }
    const double cost = evaluate_cost(graph);
    EXPECT_NEAR(test::evaluate(LiftedResidual(edge, d, d), blocks).squaredNorm(), cost, 1e-12 * cost);
  }
}

TEST(StiefelManifold, StepsStayOnItAndBeginAlongTheBasis) {
  test::RandomPoses random(2);
  for (const int d : {2, 3}) {
    for (int r = d; r <= d + 2; ++r) {
      const StiefelManifold manifold(r, d);
      const Eigen::MatrixXd y = StiefelManifold::nearest(random_matrix(random, r, d));
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> basis(manifold.AmbientSize(),
                                                                                   manifold.TangentSize());
      ASSERT_TRUE(manifold.PlusJacobian(y.data(), basis.data()));
      const Eigen::VectorXd delta = random_matrix(random, manifold.TangentSize(), 1);
      const auto moved = [&](double step) {
        Eigen::MatrixXd result(r, d);
        const Eigen::VectorXd scaled = step * delta;
        EXPECT_TRUE(manifold.Plus(y.data(), scaled.data(), result.data()));
        return result;
      };
      EXPECT_LT((moved(0.7).transpose() * moved(0.7) - Eigen::MatrixXd::Identity(d, d)).norm(), 1e-12);
      EXPECT_LT((moved(0.0) - y).norm(), 1e-14);
      const Eigen::MatrixXd numeric = (moved(test::kStep) - moved(-test::kStep)) / (2.0 * test::kStep);
      EXPECT_LT((numeric.reshaped() - basis * delta).norm(), test::kDifferenceError * delta.norm());
      EXPECT_EQ(Eigen::MatrixXd(basis).colPivHouseholderQr().rank(), manifold.TangentSize());
    }
  }
}

}  // namespace
}  // namespace fabloop
