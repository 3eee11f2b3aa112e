// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/odometry_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace fabloop {
namespace {

constexpr std::size_t kSteps = 2000;

/// Lengths of normal vectors in so many dimensions.
std::vector<double> lengths(int dimensions, double sigma, std::size_t count = kSteps) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, sigma);
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    double squared = 0;
    for (int axis = 0; axis < dimensions; ++axis) squared += std::pow(normal(random), 2);
    values.push_back(std::sqrt(squared));
  }
  return values;
}

std::vector<OdometryDifference> single_steps(const std::vector<double>& rotations_deg,
                                             const std::vector<double>& directions_deg) {
  std::vector<OdometryDifference> differences;
  for (std::size_t i = 0; i < rotations_deg.size(); ++i) differences.push_back({1, rotations_deg[i], directions_deg[i]});
  return differences;
}

/// What exact images say of stretches of so many steps of a noisy odometry that goes straight on.
std::vector<OdometryDifference> stretches(std::size_t num_steps, double rotation_deg, double translation) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  const auto vector = [&](double sigma) {
    return Eigen::Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random));
  };
  std::vector<OdometryDifference> differences;
  for (std::size_t i = 0; i < kSteps; ++i) {
    Pose end;
    for (std::size_t step = 0; step < num_steps; ++step) {
      end = end * Pose{rotation_from_vector(vector(rad_from_deg(rotation_deg))), Eigen::Vector3d::UnitX() + vector(translation)};
    }
    const double direction = std::acos(end.translation.normalized().x());
    differences.push_back({num_steps, deg_from_rad(rotation_angle(end.rotation)), deg_from_rad(direction)});
  }
  return differences;
}

TEST(OdometryNoise, IsFoundFromTheScatterOfTheSteps) {
  const OdometryNoise noise = estimate_odometry_noise(single_steps(lengths(3, 0.7), lengths(2, deg_from_rad(0.04))));
  // The median of 2000 draws scatters by 1.5 %.
  EXPECT_NEAR(noise.rotation_deg, 0.7, 0.05 * 0.7);
  EXPECT_NEAR(noise.translation, 0.04, 0.05 * 0.04);
}

TEST(OdometryNoise, IsFoundFromLongerStretchesWhereStepsShowNothing) {
  for (const std::size_t num_steps : {2U, 4U, 8U}) {
    const OdometryNoise noise = estimate_odometry_noise(stretches(num_steps, 0.3, 0.03));
    EXPECT_NEAR(noise.rotation_deg, 0.3, 0.05 * 0.3) << num_steps;
    // What turns explain is taken off, which leaves the rest less sure.
    EXPECT_NEAR(noise.translation, 0.03, 0.15 * 0.03) << num_steps;
  }
}

TEST(OdometryNoise, ShortStretchesComeFirst) {
  std::vector<OdometryDifference> differences = stretches(4, 3.0, 0.3);
  for (const OdometryDifference& single : single_steps(lengths(3, 0.7, 400), lengths(2, deg_from_rad(0.04), 400)))
    differences.push_back(single);
  EXPECT_NEAR(estimate_odometry_noise(differences).rotation_deg, 0.7, 0.1);
}

TEST(OdometryNoise, ResistsAFewWrongSteps) {
  std::vector<double> rotations = lengths(3, 0.7);
  std::vector<double> directions = lengths(2, deg_from_rad(0.04));
  for (std::size_t i = 0; i < kSteps; i += 10) rotations[i] = directions[i] = 60;
  const OdometryNoise noise = estimate_odometry_noise(single_steps(rotations, directions));
  // A tenth of outliers moves the median to the 56th percentile.
  EXPECT_NEAR(noise.rotation_deg, 0.7, 0.15 * 0.7);
  EXPECT_NEAR(noise.translation, 0.04, 0.15 * 0.04);
}

TEST(OdometryNoise, OfFewStepsIsTheFallback) {
  const OdometryNoise noise =
      estimate_odometry_noise(single_steps(lengths(3, 0.7, 5), lengths(2, 2, 5)), {.rotation_deg = 3, .translation = 0.2});
  EXPECT_EQ(noise.rotation_deg, 3);
  EXPECT_EQ(noise.translation, 0.2);
}

TEST(OdometryNoise, IsNeverNone) {
  const std::vector<double> zeros(50, 0.0);
  const OdometryNoise noise = estimate_odometry_noise(single_steps(zeros, zeros));
  EXPECT_GT(noise.rotation_deg, 0);
  EXPECT_GT(noise.translation, 0);
}

TEST(OdometryInformation, IsTheInverseOfTheCovariance) {
  const Matrix6d information = odometry_information(8, 0.1, {.rotation_deg = 2, .translation = 0.05});
  Matrix6d covariance = Matrix6d::Zero();
  covariance.topLeftCorner<3, 3>().diagonal().setConstant(std::pow(0.05 * 8, 2));
  covariance.bottomRightCorner<3, 3>().diagonal().setConstant(std::pow(rad_from_deg(2), 2));
  EXPECT_TRUE((information * covariance).isIdentity(1e-12));
}

TEST(OdometryInformation, OfAStandstillIsFinite) {
  const Matrix6d standstill = odometry_information(0, 0.1, {});
  EXPECT_TRUE(standstill.allFinite());
  EXPECT_EQ(standstill, odometry_information(0.1, 0.1, {}));
}

}  // namespace
}  // namespace fabloop
