// SPDX-License-Identifier: BSD-3-Clause
#include "verification/uncertain_pose.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <random>

#include "verification/map/keyframe_map.h"

namespace fabloop {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

class Uncertain : public testing::Test {
 protected:
  Vector6d random_vector(double sigma) {
    std::normal_distribution<double> normal(0, sigma);
    Vector6d v;
    for (double& value : v) value = normal(random_);
    return v;
  }
  Pose random_pose() { return moved_by(random_vector(1.0)); }
  Matrix6d random_covariance(double sigma) {
    Matrix6d root;
    for (int column = 0; column < 6; ++column) root.col(column) = random_vector(sigma);
    return root * root.transpose();
  }
  /// The pose of an error (translation, rotation vector).
  static Pose moved_by(const Vector6d& error) { return {rotation_from_vector(error.tail<3>()), error.head<3>()}; }
  /// A draw of the true pose.
  Pose draw(const UncertainPose& pose) {
    return pose.pose * moved_by(Eigen::LLT<Matrix6d>(pose.covariance).matrixL() * random_vector(1.0));
  }
  std::mt19937_64 random_{7};
};

TEST_F(Uncertain, TheAdjointMovesAnErrorAcrossAPose) {
  // A pose and an error differ from their first order by the error's square.
  constexpr double kError = 1e-5;
  constexpr double kSecondOrder = 1e-8;
  for (int trial = 0; trial < 100; ++trial) {
    const Pose a_from_b = random_pose();
    const Vector6d error_in_b = random_vector(kError);
    const Pose error_in_a = a_from_b * moved_by(error_in_b) * a_from_b.inverse();
    EXPECT_LT((pose_error({}, error_in_a) - adjoint(a_from_b) * error_in_b).norm(), kSecondOrder);
  }
}

TEST_F(Uncertain, AProductScattersAsItsCovarianceSays) {
  const UncertainPose a_from_b{random_pose(), random_covariance(1e-3)};
  const UncertainPose b_from_c{random_pose(), random_covariance(1e-3)};
  const UncertainPose a_from_c = a_from_b * b_from_c;
  constexpr int kDraws = 4000;
  Matrix6d scatter = Matrix6d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Vector6d error = pose_error(a_from_c.pose, draw(a_from_b) * draw(b_from_c));
    scatter += error * error.transpose() / kDraws;
  }
  // A variance from n draws is known to sqrt(2 / n), 2 %; five of those are allowed.
  EXPECT_LT((scatter - a_from_c.covariance).norm(), 0.1 * a_from_c.covariance.norm());
}

TEST_F(Uncertain, AnInverseScattersAsItsCovarianceSays) {
  const UncertainPose a_from_b{random_pose(), random_covariance(1e-3)};
  constexpr int kDraws = 4000;
  Matrix6d scatter = Matrix6d::Zero();
  const UncertainPose b_from_a = inverse(a_from_b);
  for (int i = 0; i < kDraws; ++i) {
    const Vector6d error = pose_error(b_from_a.pose, draw(a_from_b).inverse());
    scatter += error * error.transpose() / kDraws;
  }
  EXPECT_LT((scatter - b_from_a.covariance).norm(), 0.1 * b_from_a.covariance.norm());
}

TEST_F(Uncertain, ADistanceScattersAsItsSigmaSays) {
  const UncertainPose pose{random_pose(), random_covariance(0.004)};
  const double distance = pose.pose.translation.norm();
  constexpr int kSamples = 4000;
  double sum_of_squares = 0;
  for (int i = 0; i < kSamples; ++i) {
    const double error = draw(pose).translation.norm() / distance - 1.0;
    sum_of_squares += error * error;
  }
  // The standard deviation of so many samples is known to 1.1 %; four times that.
  EXPECT_NEAR(std::sqrt(sum_of_squares / kSamples) / relative_distance_sigma(pose), 1.0, 0.045);
  EXPECT_EQ(relative_distance_sigma({}), std::numeric_limits<double>::infinity());
}

TEST_F(Uncertain, AfterATurnTheDistanceIsKnownLessWellThanOnAStraightWay) {
  const auto walk = [](double turn_deg) {
    UncertainPose start_from_now;
    for (int i = 0; i < 8; ++i) {
      const double angle = i == 3 ? rad_from_deg(turn_deg) : 0.0;
      start_from_now = start_from_now * uncertain_step({rotation_from_vector({0, 0, angle}), {5, 0, 0}});
    }
    return relative_distance_sigma(start_from_now);
  };
  const double step = relative_distance_sigma(uncertain_step({Eigen::Quaterniond::Identity(), {5, 0, 0}}));
  EXPECT_NEAR(step, OdometryStepNoise{}.translation, 1e-12);
  EXPECT_LT(walk(0), step);
  EXPECT_LT(walk(90), step);
  EXPECT_GT(walk(170), 2 * step);
}

TEST_F(Uncertain, PoseErrorLeadsFromOneToTheOther) {
  for (int trial = 0; trial < 100; ++trial) {
    const Pose pose = random_pose(), other = random_pose();
    const Vector6d error = pose_error(pose, other);
    EXPECT_LE(error.tail<3>().norm(), kPi + 1e-12);
    EXPECT_LT(pose_error(pose * moved_by(error), other).norm(), 1e-9);
  }
}

TEST_F(Uncertain, CovarianceInvertsInformationWhereThereIsSome) {
  for (int trial = 0; trial < 100; ++trial) {
    const Matrix6d information = random_covariance(1.0) + 0.1 * Matrix6d::Identity();
    EXPECT_LT((covariance_of(information) * information - Matrix6d::Identity()).norm(), 1e-8);
    // Nothing is known along one direction.
    Vector6d along = Vector6d::Zero();
    along.head<3>() = random_vector(1.0).head<3>().normalized();
    const Matrix6d across = Matrix6d::Identity() - along * along.transpose();
    const Matrix6d covariance = covariance_of(across * information * across);
    EXPECT_LT((covariance * along).norm(), 1e-9);
    EXPECT_LT((covariance * across * information * across - across).norm(), 1e-8);
  }
}

TEST_F(Uncertain, WhatMayBeACovarianceIsTold) {
  EXPECT_TRUE(is_covariance(Matrix6d::Zero()));
  EXPECT_TRUE(is_covariance(random_covariance(1.0)));
  Matrix6d rank_one = Matrix6d::Zero();
  rank_one(2, 2) = 4;
  EXPECT_TRUE(is_covariance(rank_one));
  Matrix6d skew = random_covariance(1.0);
  skew(0, 3) += 1e-3;
  EXPECT_FALSE(is_covariance(skew));
  Matrix6d negative = Matrix6d::Identity();
  negative(5, 5) = -1e-3;
  EXPECT_FALSE(is_covariance(negative));
  Matrix6d unknown = Matrix6d::Identity();
  unknown(1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(is_covariance(unknown));
}

}  // namespace
}  // namespace fabloop
