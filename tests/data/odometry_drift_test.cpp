// SPDX-License-Identifier: BSD-3-Clause
#include "data/odometry_drift.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "data/flight_plan.h"
#include "frontend/error.h"

namespace fabloop {
namespace {

/// Root mean square of what remains after a rigid alignment.
double ate_rmse(const std::vector<Pose>& estimate, const std::vector<Pose>& truth) {
  Eigen::Matrix3Xd from(3, estimate.size());
  Eigen::Matrix3Xd to(3, truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = estimate[i].translation;
    to.col(static_cast<Eigen::Index>(i)) = truth[i].translation;
  }
  const Eigen::Matrix4d aligned = Eigen::umeyama(from, to, false);
  const Eigen::Matrix3Xd residual = ((aligned.topLeftCorner<3, 3>() * from).colwise() + aligned.topRightCorner<3, 1>()) - to;
  return std::sqrt(residual.colwise().squaredNorm().mean());
}

TEST(OdometryDrift, IsTheTruthWithoutErrors) {
  FlightOptions flight;
  flight.length_m = 100;
  const auto truth = plan_flight(flight);
  const auto odometry = drifting_odometry(truth, {1, 0, 0, 0, 0});
  ASSERT_EQ(odometry.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_LT((odometry[i].translation - truth[i].translation).norm(), 1e-9);
    EXPECT_LT(rotation_angle(odometry[i].rotation.conjugate() * truth[i].rotation), 1e-9);
  }
}

TEST(OdometryDrift, StepsErrByWhatIsStated) {
  const auto truth = plan_flight();
  const DriftOptions options;
  const auto odometry = drifting_odometry(truth, options);
  double translation = 0;
  double rotation_deg = 0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Pose true_step = truth[i - 1].inverse() * truth[i];
    const Pose step = odometry[i - 1].inverse() * odometry[i];
    translation += (step.translation - true_step.translation).norm() / true_step.translation.norm();
    rotation_deg += deg_from_rad(rotation_angle(true_step.rotation.conjugate() * step.rotation));
  }
  const auto steps = static_cast<double>(truth.size() - 1);
  // The mean length of a normal vector in space is 1.6 deviations of an axis.
  EXPECT_NEAR(translation / steps, std::hypot(1.6 * options.translation_noise, options.scale_error), 0.006);
  EXPECT_NEAR(rotation_deg / steps, 1.6 * options.rotation_noise_deg, 0.06);
}

TEST(OdometryDrift, AFullFlightIsTenToTwentyFiveMetresOff) {
  const auto truth = plan_flight();
  std::vector<double> errors;
  for (std::uint64_t seed = 1; seed <= 9; ++seed) {
    DriftOptions drift;
    drift.seed = seed;
    errors.push_back(ate_rmse(drifting_odometry(truth, drift), truth));
    EXPECT_GT(errors.back(), 3) << "seed " << seed;
    EXPECT_LT(errors.back(), 40) << "seed " << seed;
  }
  std::nth_element(errors.begin(), errors.begin() + 4, errors.end());
  EXPECT_GT(errors[4], 10);
  EXPECT_LT(errors[4], 25);
}

TEST(OdometryDrift, RefusesErrorsThatAreNone) {
  DriftOptions options;
  options.rotation_noise_deg = -1;
  EXPECT_THROW(drifting_odometry({}, options), InputError);
  options = {};
  options.scale_error = std::nan("");
  EXPECT_THROW(drifting_odometry({}, options), InputError);
}

}  // namespace
}  // namespace fabloop
