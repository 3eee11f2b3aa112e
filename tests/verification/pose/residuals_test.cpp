// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/residuals.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <functional>

#include "tests/verification/two_view_world.h"

namespace fabloop {
namespace {

constexpr double kDifference = 1e-6;
/// Central differences of values near 1 are good to about step^2 and rounding over the step.
constexpr double kTolerance = 1e-8;

Eigen::Vector3d numeric_gradient(const std::function<double(const Eigen::Vector3d&)>& function) {
  Eigen::Vector3d gradient;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = kDifference * Eigen::Vector3d::Unit(k);
    gradient(k) = (function(step) - function(-step)) / (2.0 * kDifference);
  }
  return gradient;
}

TEST(EpipolarResidual, DerivativesAreThoseOfTheAngle) {
  // Outliers have large residuals, where the derivative of the denominator matters.
  const auto world = testing_support::make_two_views({.num_points = 200, .outlier_ratio = 0.5, .noise_px = 3});
  const Pose& pose = world.match_from_query;
  const auto angle = [&](const RayPair& pair, const Pose& at) {
    return epipolar_residual(pair.query, pair.match, essential_matrix(at)).angle();
  };
  const Eigen::Matrix3d essential = essential_matrix(pose);
  for (const RayPair& pair : world.pairs) {
    const EpipolarJacobian jacobian =
        epipolar_jacobian(epipolar_residual(pair.query, pair.match, essential), pair.query, pair.match, essential,
                          pose.rotation.toRotationMatrix(), pose.translation);
    const Eigen::Vector3d by_rotation = numeric_gradient([&](const Eigen::Vector3d& step) {
      return angle(pair, {pose.rotation * rotation_from_vector(step), pose.translation});
    });
    const Eigen::Vector3d by_translation = numeric_gradient([&](const Eigen::Vector3d& step) {
      return angle(pair, {pose.rotation, pose.translation + step});
    });
    EXPECT_LT((jacobian.by_rotation - by_rotation).norm(), kTolerance);
    EXPECT_LT((jacobian.by_translation - by_translation).norm(), kTolerance);
  }
}

TEST(EpipolarResidual, IsTheAngleThatOneRayMustTurn) {
  // To first order the least turn of both rays that brings them into one epipolar plane; half of it each when alike.
  const auto world = testing_support::make_two_views({.num_points = 50});
  const Eigen::Matrix3d essential = essential_matrix(world.match_from_query);
  for (const RayPair& pair : world.pairs) {
    const Eigen::Vector3d normal = (essential * pair.query).normalized();
    constexpr double kTurn = 1e-4;
    const Eigen::Vector3d turned = (pair.match + kTurn * normal).normalized();
    const EpipolarResidual residual = epipolar_residual(pair.query, turned, essential);
    EXPECT_LE(std::abs(residual.angle()), kTurn * (1 + 1e-3));
    EXPECT_GT(std::abs(residual.angle()), 0.3 * kTurn);
  }
}

TEST(DirectionResidual, DerivativeIsThatOfTheValue) {
  const Eigen::Vector3d ray = Eigen::Vector3d(0.2, -0.1, 1).normalized();
  const Eigen::Vector3d x(1.5, -0.4, 8);
  const DirectionResidual residual = direction_residual(x, ray);
  for (int row = 0; row < 2; ++row) {
    const Eigen::Vector3d gradient =
        numeric_gradient([&](const Eigen::Vector3d& step) { return direction_residual(x + step, ray).value(row); });
    EXPECT_LT((residual.by_point.row(row).transpose() - gradient).norm(), kTolerance);
  }
}

TEST(RayDepths, AreWhereTheRaysMeet) {
  const Eigen::Vector3d x_in_match(1, -2, 9), translation(2, 0.3, -0.5);
  const Eigen::Vector3d from_query = x_in_match - translation;
  const RayDepths depths = ray_depths(from_query.normalized(), x_in_match.normalized(), translation);
  EXPECT_NEAR(depths.query / depths.squared_sine, from_query.norm(), 1e-9);
  EXPECT_NEAR(depths.match / depths.squared_sine, x_in_match.norm(), 1e-9);
}

}  // namespace
}  // namespace fabloop
