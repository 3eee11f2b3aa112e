// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <vector>

namespace fabloop::test {

/// Central differences with steps of 1e-6 are off by about 1e-12 times a third derivative, and by 1e-16 / 1e-6 times the value.
inline constexpr double kStep = 1e-6;
inline constexpr double kDifferenceError = 1e-7;

using Blocks = std::vector<std::vector<double>>;

inline Eigen::VectorXd evaluate(const ceres::CostFunction& cost, const Blocks& blocks) {
  std::vector<const double*> pointers;
  for (const auto& block : blocks) pointers.push_back(block.data());
  Eigen::VectorXd residual(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(pointers.data(), residual.data(), nullptr));
  return residual;
}

/// Every analytic derivative against central differences.
inline void expect_derivatives(const ceres::CostFunction& cost, const Blocks& blocks) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<RowMajor> analytic;
  for (const auto& block : blocks) analytic.emplace_back(cost.num_residuals(), block.size());
  std::vector<const double*> pointers;
  std::vector<double*> jacobians;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    pointers.push_back(blocks[b].data());
    jacobians.push_back(analytic[b].data());
  }
  Eigen::VectorXd residual(cost.num_residuals());
  ASSERT_TRUE(cost.Evaluate(pointers.data(), residual.data(), jacobians.data()));
  EXPECT_EQ(residual, evaluate(cost, blocks)) << "asking for derivatives changes nothing";
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (std::size_t k = 0; k < blocks[b].size(); ++k) {
      Blocks ahead = blocks;
      Blocks behind = blocks;
      ahead[b][k] += kStep;
      behind[b][k] -= kStep;
      const Eigen::VectorXd numeric = (evaluate(cost, ahead) - evaluate(cost, behind)) / (2.0 * kStep);
      const Eigen::VectorXd column = analytic[b].col(static_cast<Eigen::Index>(k));
      EXPECT_LT((numeric - column).norm(), kDifferenceError * (1.0 + column.norm())) << "block " << b << ", number " << k;
    }
  }
}

}  // namespace fabloop::test
