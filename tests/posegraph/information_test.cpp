// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/information.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

namespace fabloop {
namespace {

Matrix6d random_information(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Matrix6d factor;
  for (double& value : factor.reshaped()) value = normal(random);
  return factor * factor.transpose();
}

TEST(Information, TheWhiteningFactorSquaresToTheInformation) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    Matrix6d information = random_information(seed);
    if (seed % 2 == 1) information.row(2).setZero(), information.col(2).setZero();
    const Eigen::MatrixXd w = whitening(information);
    EXPECT_LT((w.transpose() * w - information).norm(), 1e-12 * information.norm()) << seed;
  }
}

TEST(Information, TheNearestSemidefiniteMatrixLosesOnlyTheNegativePart) {
  const Eigen::Matrix2d indefinite = (Eigen::Matrix2d() << 1, 2, 2, 1).finished();
  EXPECT_FALSE(is_positive_semidefinite(indefinite));
  // Eigenvalues 3 and -1: what is left is 3 v v^T with v = (1, 1) / sqrt(2).
  EXPECT_LT((nearest_positive_semidefinite(indefinite) - Eigen::Matrix2d::Constant(1.5)).norm(), 1e-12);
  EXPECT_TRUE(is_positive_semidefinite(Eigen::Matrix2d::Constant(1.5)));
  const Matrix6d good = random_information(1);
  EXPECT_LT((nearest_positive_semidefinite(good) - good).norm(), 1e-12 * good.norm());
}

TEST(Information, ChordalWeightsAreTheFormulas) {
  Edge edge;
  edge.information.diagonal() << 1, 2, 4, 10, 20, 40;
  EXPECT_DOUBLE_EQ(chordal_weights(edge, 3).tau, 3.0 / 1.75);
  EXPECT_DOUBLE_EQ(chordal_weights(edge, 3).kappa, 3.0 / (2.0 * 0.175));
  EXPECT_DOUBLE_EQ(chordal_weights(edge, 2).tau, 2.0 / 1.5);
  EXPECT_DOUBLE_EQ(chordal_weights(edge, 2).kappa, 40.0);
  edge.has_scale = false;
  edge.from_from_to.translation = {0, 0, 7};
  EXPECT_DOUBLE_EQ(chordal_weights(edge, 3).tau, 2.0 / 1.5) << "only across the direction";
  edge.information.setZero();
  EXPECT_DOUBLE_EQ(chordal_weights(edge, 3).tau, 0.0);
  EXPECT_DOUBLE_EQ(chordal_weights(edge, 3).kappa, 0.0);
}

TEST(Information, TheTangentBasisIsOrthonormalAndAcross) {
  for (const Eigen::Vector3d& direction : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(1, 2, 3)}) {
    const Eigen::Vector3d unit = direction.normalized();
    const Eigen::Matrix<double, 3, 2> basis = tangent_basis(unit);
    EXPECT_LT((basis.transpose() * basis - Eigen::Matrix2d::Identity()).norm(), 1e-14);
    EXPECT_LT((basis.transpose() * unit).norm(), 1e-14);
  }
}

}  // namespace
}  // namespace fabloop
