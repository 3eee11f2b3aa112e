// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/verification/rig_world.h"
#include "verification/pose/point_ray_residual.h"
#include "verification/rig/rig_epipolar.h"

namespace fabloop {
namespace {

using testing_support::make_rig_world;
using testing_support::RigWorld;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kStep = 1e-6;
constexpr double kNumericError = 1e-7;  // of central differences with that step, over values around one

template <typename Function>
auto numeric_jacobian(const Function& residual_at) {
  Eigen::Matrix<double, Eigen::Dynamic, 6> jacobian(residual_at(Vector6d(Vector6d::Zero())).size(), 6);
  for (int column = 0; column < 6; ++column) {
    const Vector6d step = kStep * Vector6d::Unit(column);
    jacobian.col(column) = (residual_at(step) - residual_at(Vector6d(-step))) / (2 * kStep);
  }
  return jacobian;
}

TEST(PointRaySum, IsTheSumOfNumericDerivatives) {
  const RigWorld world = make_rig_world({.num_data = 20, .noise_rad = 0.05});
  for (const RigPointRay& datum : world.points_and_rays) {
    const auto residual_at = [&](const Vector6d& step) -> Eigen::VectorXd {
      const Pose world_from_body{world.match_from_query.rotation * rotation_from_vector(step.tail<3>()),
                                 world.match_from_query.translation + step.head<3>()};
      const Eigen::Vector3d x = world_from_body.inverse() * datum.point_in_world;
      return (x - datum.ray.origin_in_body).normalized() - datum.ray.ray_in_body;
    };
    PointRaySum sum;
    sum.add(world.match_from_query.inverse() * datum.point_in_world, datum.ray.origin_in_body, datum.ray.ray_in_body);
    const NormalEquations<6> normal = sum.in_world(world.match_from_query.rotation.toRotationMatrix());
    const auto jacobian = numeric_jacobian(residual_at);
    const Eigen::VectorXd residual = residual_at(Vector6d::Zero());
    EXPECT_LT((normal.hessian - jacobian.transpose() * jacobian).norm(), kNumericError);
    EXPECT_LT((normal.gradient - jacobian.transpose() * residual).norm(), kNumericError);
    EXPECT_NEAR(normal.cost, residual.squaredNorm(), 1e-15);
  }
}

TEST(RigResidual, HasTheNumericDerivative) {
  const RigWorld world = make_rig_world({.num_data = 20, .noise_rad = 0.05});
  for (const RigRayPair& pair : world.pairs) {
    const auto residual_at = [&](const Vector6d& step) -> Eigen::VectorXd {
      const Pose& pose = world.match_from_query;
      const Pose moved{pose.rotation * rotation_from_vector(step.tail<3>()), pose.translation + pose.rotation * step.head<3>()};
      const RigResidual residual = rig_residual(pair, BodyMotion::from(moved));
      return Eigen::VectorXd::Constant(1, residual.error / residual.gradient_norm);
    };
    NormalEquations<6> normal;
    add_rig_residual(pair, BodyMotion::from(world.match_from_query), normal);
    const auto jacobian = numeric_jacobian(residual_at);
    EXPECT_LT((normal.hessian - jacobian.transpose() * jacobian).norm(), kNumericError * (1 + normal.hessian.norm()));
    const Eigen::VectorXd residual = residual_at(Vector6d::Zero());
    EXPECT_LT((normal.gradient - jacobian.transpose() * residual).norm(), kNumericError * (1 + normal.gradient.norm()));
  }
}

TEST(RigResidual, IsAnAngleAndDoesNotChangeAlongTheBaseline) {
  const RigWorld world = make_rig_world({.num_data = 50, .noise_rad = 0.01});
  for (const RigRayPair& pair : world.pairs) {
    const BodyMotion motion = BodyMotion::from(world.match_from_query);
    BodyMotion longer = motion;
    longer.translation += 2 * baseline_in_match(pair, motion);
    EXPECT_NEAR(squared_rig_error(pair, motion), squared_rig_error(pair, longer), 1e-15);
    NormalEquations<6> normal;
    add_rig_residual(pair, motion, normal);
    const Eigen::Vector3d along = motion.rotation.transpose() * baseline_in_match(pair, motion).normalized();
    EXPECT_LT(along.dot(normal.hessian.topLeftCorner<3, 3>() * along), 1e-20 + 1e-15 * normal.hessian.trace());
  }
}

TEST(RigResidual, WithoutABaselineRaysMustBeParallel) {
  const RigRayPair parallel{{{0.1, 0, 0}, {0, 0, 1}}, {{0.1, 0, 0}, {0, 0, 1}}};
  RigRayPair apart = parallel;
  apart.match.ray_in_body = rotation_from_vector({0.02, 0, 0}) * apart.match.ray_in_body;
  const BodyMotion at_rest{Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()};
  EXPECT_EQ(squared_rig_error(parallel, at_rest), 0);
  EXPECT_NEAR(std::sqrt(squared_rig_error(apart, at_rest)), 0.02, 1e-5);
}

}  // namespace
}  // namespace fabloop
