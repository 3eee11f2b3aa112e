// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/epipolar_cost.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>

#include "tests/verification/two_view_world.h"
#include "verification/pose/residuals.h"

namespace fabloop {
namespace {

constexpr double kCutoffRad = 0.004;

EpipolarData data_of(const std::vector<RayPair>& pairs) {
  EpipolarData data(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) data.set(i, pairs[i].query.data(), pairs[i].match.data());
  return data;
}

std::array<double, 9> rows_of(const Eigen::Matrix3d& essential) {
  std::array<double, 9> rows;
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data()) = essential;
  return rows;
}

double plain_cost(const std::vector<RayPair>& pairs, const Eigen::Matrix3d& essential) {
  double cost = 0;
  for (const RayPair& pair : pairs) {
    const double error = epipolar_residual(pair.query, pair.match, essential).angle() / kCutoffRad;
    cost += std::min(1.0, error * error);
  }
  return cost;
}

TEST(EpipolarCost, IsTheSumOfTruncatedSampsonDistances) {
  for (const int num_pairs : {1, 7, 8, 31, 32, 33, 200}) {
    const auto world = testing_support::make_two_views({.num_points = num_pairs, .outlier_ratio = 0.5, .noise_px = 0.5});
    const Eigen::Matrix3d essential = essential_matrix(world.match_from_query);
    // Single precision: an error of 1e-7 in a distance of up to 4e-3, twice.
    constexpr double kRelative = 1e-3;
    EXPECT_NEAR(data_of(world.pairs).cost(rows_of(essential), kCutoffRad), plain_cost(world.pairs, essential),
                kRelative * num_pairs);
  }
}

TEST(EpipolarCost, DoesNotDependOnTheMatrixsScaleOrSign) {
  const auto world = testing_support::make_two_views({.outlier_ratio = 0.3, .noise_px = 0.5});
  const Eigen::Matrix3d essential = essential_matrix(world.match_from_query);
  const EpipolarData data = data_of(world.pairs);
  const double cost = data.cost(rows_of(essential), kCutoffRad);
  EXPECT_NEAR(data.cost(rows_of(-7.0 * essential), kCutoffRad), cost, 1e-3 * cost);
}

TEST(EpipolarCost, AboveTheBoundTheSumIsLeftUnfinished) {
  const auto world = testing_support::make_two_views({.num_points = 300, .outlier_ratio = 1.0});
  const EpipolarData data = data_of(world.pairs);
  const auto rows = rows_of(essential_matrix(world.match_from_query));
  constexpr double kBound = 10;
  const double cost = data.cost(rows, kCutoffRad, kBound);
  EXPECT_GT(cost, kBound);
  EXPECT_LT(cost, 0.5 * data.cost(rows, kCutoffRad));
}

}  // namespace
}  // namespace fabloop
