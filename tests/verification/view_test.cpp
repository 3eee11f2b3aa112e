// SPDX-License-Identifier: BSD-3-Clause
#include "verification/view.h"

#include <gtest/gtest.h>

#include "frontend/geometry/pose.h"
#include "tests/verification/two_view_world.h"

namespace fabloop {
namespace {

using testing_support::test_camera;

constexpr double kParallaxRad = 0.1;

View view_of_one_feature() {
  Features features;
  features.keypoints.emplace_back(319.5F, 239.5F, 3.0F);
  return make_view(7, test_camera(), features);
}

TEST(View, HasARayForEachFeatureAndNoPoints) {
  const View view = view_of_one_feature();
  EXPECT_EQ(view.frame, 7U);
  ASSERT_EQ(view.rays.size(), 1U);
  EXPECT_LT((view.rays[0] - Eigen::Vector3d::UnitZ()).norm(), 1e-6);  // the principal point
  EXPECT_EQ(view.points_in_camera.size(), 1U);
  EXPECT_EQ(view.point_weights.size(), 1U);
  EXPECT_EQ(count_points(view), 0U);
}

TEST(PointMeasurement, TheFirstIsTaken) {
  View view = view_of_one_feature();
  add_point_measurement(view, 0, {0, 0, 10}, kParallaxRad);
  EXPECT_EQ(count_points(view), 1U);
  EXPECT_EQ(*view.points_in_camera[0], Eigen::Vector3d(0, 0, 10));
}

TEST(PointMeasurement, SeveralBecomeTheMeanByParallax) {
  View view = view_of_one_feature();
  add_point_measurement(view, 0, {0, 0, 10}, kParallaxRad);
  add_point_measurement(view, 0, {0, 0, 10.5}, 2 * kParallaxRad);
  ASSERT_TRUE(view.points_in_camera[0].has_value());
  EXPECT_NEAR(view.points_in_camera[0]->z(), (10 + 4 * 10.5) / 5, 1e-12);
  add_point_measurement(view, 0, {0, 0, 10.2}, kParallaxRad);
  EXPECT_NEAR(view.points_in_camera[0]->z(), (10 + 4 * 10.5 + 10.2) / 6, 1e-12);
}

TEST(PointMeasurement, TheirOrderDoesNotMatter) {
  View a = view_of_one_feature();
  View b = view_of_one_feature();
  add_point_measurement(a, 0, {0, 0, 10}, kParallaxRad);
  add_point_measurement(a, 0, {0, 0, 10.5}, 2 * kParallaxRad);
  add_point_measurement(b, 0, {0, 0, 10.5}, 2 * kParallaxRad);
  add_point_measurement(b, 0, {0, 0, 10}, kParallaxRad);
  EXPECT_LT((*a.points_in_camera[0] - *b.points_in_camera[0]).norm(), 1e-12);
  EXPECT_NEAR(a.point_weights[0], b.point_weights[0], 1e-15);
}

TEST(PointMeasurement, AContradictionLosesThePointUntilItIsMeasuredAgain) {
  View view = view_of_one_feature();
  add_point_measurement(view, 0, {0, 0, 10}, kParallaxRad);
  add_point_measurement(view, 0, {0, 0, 20}, kParallaxRad);
  EXPECT_EQ(count_points(view), 0U);
  add_point_measurement(view, 0, {0, 0, 20}, kParallaxRad);
  ASSERT_EQ(count_points(view), 1U);
  EXPECT_EQ(view.points_in_camera[0]->z(), 20);
}

TEST(PointMeasurement, LittleParallaxAllowsMoreDifference) {
  View view = view_of_one_feature();
  add_point_measurement(view, 0, {0, 0, 10}, 0.02);
  add_point_measurement(view, 0, {0, 0, 16}, 0.02);
  EXPECT_EQ(count_points(view), 1U);
}

}  // namespace
}  // namespace fabloop
