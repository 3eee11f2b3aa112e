// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/residuals/residuals.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/posegraph/numeric_derivatives.h"
#include "tests/posegraph/objectives.h"
#include "tests/posegraph/random_graph.h"

namespace fabloop {
namespace {

using residuals::make_residual;
using test::Blocks;
using test::evaluate;
using test::expect_derivatives;

using test::kObjectives;

Blocks spatial_blocks(const Pose& i, const Pose& j) {
  const auto numbers = [](const auto& v) { return std::vector<double>(v.data(), v.data() + v.size()); };
  return {numbers(i.rotation.coeffs()), numbers(i.translation), numbers(j.rotation.coeffs()), numbers(j.translation)};
}

TEST(Residuals, SpatialDerivativesAreThoseOfDifferences) {
  test::RandomPoses random(1);
  for (int trial = 0; trial < 20; ++trial) {
    Edge edge;
    edge.from_from_to = random.pose(5.0);
    edge.information = random.information();
    edge.has_scale = trial % 2 == 0;
    const Pose i = random.pose(5.0);
    // Near the measurement and anywhere.
    const Pose j = trial % 4 < 2 ? i * edge.from_from_to * random.pose(0.1, 0.1) : random.pose(5.0);
    for (const Objective objective : kObjectives) expect_derivatives(*make_residual(edge, 3, objective), spatial_blocks(i, j));
  }
}

TEST(Residuals, DerivativesHoldWhereTheErrorIsZero) {
  test::RandomPoses random(2);
  Edge edge;
  edge.from_from_to = random.pose(1.0);
  edge.information = random.information();
  const Pose i = random.pose(1.0);
  for (const Objective objective : kObjectives) {
    expect_derivatives(*make_residual(edge, 3, objective), spatial_blocks(i, i * edge.from_from_to));
  }
}

TEST(Residuals, BothQuaternionsOfARotationGiveTheSameCost) {
  test::RandomPoses random(3);
  for (int trial = 0; trial < 20; ++trial) {
    Edge edge;
    edge.from_from_to = random.pose(5.0);
    edge.information = random.information();
    const Pose i = random.pose(5.0);
    const Pose j = random.pose(5.0);
    Pose same = j;
    same.rotation.coeffs() *= -1.0;
    for (const Objective objective : kObjectives) {
      const auto cost = make_residual(edge, 3, objective);
      const double squared = evaluate(*cost, spatial_blocks(i, j)).squaredNorm();
      EXPECT_NEAR(evaluate(*cost, spatial_blocks(i, same)).squaredNorm(), squared, 1e-12 * squared);
    }
  }
}

TEST(Residuals, ChordalCostIsThatOfMatrices) {
  test::RandomPoses random(4);
  for (int trial = 0; trial < 20; ++trial) {
    Edge edge;
    edge.from_from_to = random.pose(5.0);
    edge.information = random.information();
    const ChordalWeights weights = chordal_weights(edge, 3);
    const Pose i = random.pose(5.0);
    const Pose j = random.pose(5.0);
    const Pose predicted = i * edge.from_from_to;
    const double expected =
        weights.kappa * (j.rotation.toRotationMatrix() - predicted.rotation.toRotationMatrix()).squaredNorm() +
        weights.tau * (j.translation - predicted.translation).squaredNorm();
    const double squared = evaluate(*make_residual(edge, 3, Objective::Chordal), spatial_blocks(i, j)).squaredNorm();
    EXPECT_NEAR(squared, expected, 1e-12 * expected);
  }
}

TEST(Residuals, PlanarDerivativesAreThoseOfDifferences) {
  test::RandomPoses random(5);
  for (int trial = 0; trial < 20; ++trial) {
    Edge edge;
    edge.from_from_to = random.planar_pose(5.0);
    edge.information = random.information();
    const Blocks blocks = {{random.number(), random.number(), 3.0 * random.number()},
                           {random.number(), random.number(), 3.0 * random.number()}};
    for (const Objective objective : kObjectives) expect_derivatives(*make_residual(edge, 2, objective), blocks);
  }
}

}  // namespace
}  // namespace fabloop
