// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/epipolar_equations.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "tests/verification/two_view_world.h"
#include "verification/pose/residuals.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViews;

constexpr double kTolerance = 1e-9;  // of sums of some hundred terms of up to one

/// A pose near the truth, so that residuals are not zero, as Eigen's types and as plain numbers.
struct Case {
  explicit Case(const TwoViews& world) : pairs(world.pairs), equations(world.pairs.size()) {
    pose = {world.match_from_query.rotation * rotation_from_vector({0.01, -0.02, 0.005}),
            (world.match_from_query.translation + Eigen::Vector3d(0.05, 0.02, -0.1)).normalized()};
    essential = essential_matrix(pose);
    rotation = pose.rotation.toRotationMatrix();
    basis.col(0) = pose.translation.unitOrthogonal();
    basis.col(1) = pose.translation.cross(basis.col(0));
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    Eigen::Map<RowMajor>(frame.rotation.data()) = rotation;
    Eigen::Map<RowMajor>(frame.essential.data()) = essential;
    Eigen::Map<Eigen::Vector3d>(frame.translation.data()) = pose.translation;
    Eigen::Map<Eigen::Matrix<double, 3, 2>>(frame.basis.data()) = basis;
    for (std::size_t i = 0; i < pairs.size(); ++i) equations.set(i, pairs[i].query.data(), pairs[i].match.data(), weight(i));
  }

  static double weight(std::size_t i) { return 0.25 + 0.5 * static_cast<double>(i % 2); }

  EpipolarResidual residual(std::size_t i) const { return epipolar_residual(pairs[i].query, pairs[i].match, essential); }

  Eigen::Matrix<double, 5, 1> row(std::size_t i) const {
    const EpipolarJacobian derivative =
        epipolar_jacobian(residual(i), pairs[i].query, pairs[i].match, essential, rotation, pose.translation);
    Eigen::Matrix<double, 5, 1> result;
    result << derivative.by_rotation, basis.transpose() * derivative.by_translation;
    return result;
  }

  std::vector<RayPair> pairs;
  EpipolarEquations equations;
  Pose pose;
  Eigen::Matrix3d essential, rotation;
  Eigen::Matrix<double, 3, 2> basis;
  EpipolarFrame frame;
};

class EpipolarEquationsOf : public ::testing::TestWithParam<int> {
 protected:
  Case of{make_two_views({.num_points = GetParam(), .outlier_ratio = 0.3, .noise_px = 0.5})};
};

TEST_P(EpipolarEquationsOf, JacobianIsThatOfOnePairAtATime) {
  const auto rows = of.equations.jacobian(of.frame);
  ASSERT_EQ(rows.size(), of.pairs.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Map<const Eigen::Matrix<double, 5, 1>> row(rows[i].data());
    EXPECT_LT((row - of.row(i)).norm(), kTolerance) << i;
  }
}

TEST_P(EpipolarEquationsOf, SumsAreWeighed) {
  Eigen::Matrix<double, 5, 5> hessian = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> gradient = Eigen::Matrix<double, 5, 1>::Zero();
  double cost = 0;
  for (std::size_t i = 0; i < of.pairs.size(); ++i) {
    const double angle = of.residual(i).angle();
    hessian += Case::weight(i) * of.row(i) * of.row(i).transpose();
    gradient += Case::weight(i) * angle * of.row(i);
    cost += Case::weight(i) * angle * angle;
  }
  const EpipolarSums sums = of.equations.linearise(of.frame);
  EXPECT_NEAR(sums.cost, cost, kTolerance);
  std::size_t next = 0;
  for (int r = 0; r < 5; ++r) {
    EXPECT_NEAR(sums.gradient[static_cast<std::size_t>(r)], gradient(r), kTolerance);
    for (int c = 0; c <= r; ++c) EXPECT_NEAR(sums.hessian[next++], hessian(r, c), kTolerance) << r << ' ' << c;
  }
}

TEST_P(EpipolarEquationsOf, AnglesOfPairsBehindACameraAreHalfATurn) {
  constexpr double kMaxErrorRad = 0.05;
  const std::vector<double> angles = of.equations.angles(of.frame, kMaxErrorRad);
  ASSERT_EQ(angles.size(), of.pairs.size());
  int num_behind = 0;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const RayDepths depths = ray_depths(of.rotation * of.pairs[i].query, of.pairs[i].match, of.pose.translation);
    const bool in_front = depths.squared_sine < kMaxErrorRad * kMaxErrorRad || (depths.query > 0 && depths.match > 0);
    const double angle = of.residual(i).angle();
    const bool behind = std::abs(angle) < kMaxErrorRad && !in_front;
    EXPECT_NEAR(angles[i], behind ? kPi : angle, kTolerance) << i;
    num_behind += behind;
  }
  if (angles.size() >= 200) {
    EXPECT_GT(num_behind, 0) << "of the outliers some";
  }
}

// Of one lane, of a whole number of vectors, and of one pair more.
INSTANTIATE_TEST_SUITE_P(Sizes, EpipolarEquationsOf, ::testing::Values(1, 4, 5, 200));

}  // namespace
}  // namespace fabloop
