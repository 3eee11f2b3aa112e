// SPDX-License-Identifier: BSD-3-Clause
#include "data/flight_plan.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "frontend/error.h"

namespace fabloop {
namespace {

double length_of(const std::vector<Pose>& poses) {
  double length_m = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) length_m += (poses[i].translation - poses[i - 1].translation).norm();
  return length_m;
}

TEST(FlightPlan, IsAsLongAsAsked) {
  for (const double length_m : {100.0, 300.0, 700.0}) {
    FlightOptions options;
    options.length_m = length_m;
    const auto poses = plan_flight(options);
    // Chords cut the rounded corners a little, and the last frame falls within a spacing of the end.
    EXPECT_NEAR(length_of(poses), length_m, 0.03 * length_m + options.spacing_m) << length_m;
    EXPECT_NEAR(static_cast<double>(poses.size()), length_m / options.spacing_m + 1, 2) << length_m;
  }
}

TEST(FlightPlan, LooksDownFromItsHeights) {
  FlightOptions options;
  options.length_m = 300;
  for (const auto& pose : plan_flight(options)) {
    EXPECT_GE(pose.translation.z(), options.mean_height_m - options.height_spread_m);
    EXPECT_LE(pose.translation.z(), options.mean_height_m + options.height_spread_m);
    const Eigen::Vector3d forward_in_world = pose.rotation * Eigen::Vector3d::UnitZ();
    EXPECT_LT(forward_in_world.z(), std::cos(rad_from_deg(25)) * -1.0);
  }
}

TEST(FlightPlan, TopOfThePictureIsTowardsTheFlight) {
  FlightOptions options;
  options.length_m = 300;
  options.tilt_deg = 0;
  const auto poses = plan_flight(options);
  const Eigen::Vector3d travel = (poses[3].translation - poses[2].translation).normalized();
  EXPECT_GT(travel.dot(poses[2].rotation * -Eigen::Vector3d::UnitY()), 0.95);
}

TEST(FlightPlan, ReturnsToPlacesInBothDirections) {
  FlightOptions options;
  options.length_m = 300;
  const auto poses = plan_flight(options);
  int same = 0;
  int opposite = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t j = i + 11; j < poses.size(); ++j) {
      if ((poses[i].translation - poses[j].translation).head<2>().norm() > 6) continue;
      const double heading = (poses[i].rotation * Eigen::Vector3d::UnitY()).dot(poses[j].rotation * Eigen::Vector3d::UnitY());
      if (heading > 0.8) ++same;
      if (heading < -0.8) ++opposite;
    }
  }
  EXPECT_GE(same, 3);
  EXPECT_GE(opposite, 3);
}

TEST(FlightPlan, RefusesWhatIsNoFlight) {
  FlightOptions options;
  options.length_m = 10;
  EXPECT_THROW(plan_flight(options), InputError);
  options = {};
  options.spacing_m = 0;
  EXPECT_THROW(plan_flight(options), InputError);
  options = {};
  options.mean_height_m = std::nan("");
  EXPECT_THROW(plan_flight(options), InputError);
}

}  // namespace
}  // namespace fabloop
