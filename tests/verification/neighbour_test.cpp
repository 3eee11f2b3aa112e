// SPDX-License-Identifier: BSD-3-Clause
#include "verification/neighbour.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/verification/two_view_world.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using testing_support::TwoViews;

/// The truth, off by a rotation about the view's axis.
Pose turned(const Pose& truth, double degrees) {
  return {truth.rotation * rotation_from_vector({0, 0, rad_from_deg(degrees)}), truth.translation};
}

/// The truth with its direction turned about the view's axis.
Pose with_direction_turned(const Pose& truth, double degrees) {
  return {truth.rotation, rotation_from_vector({0, 0, rad_from_deg(degrees)}) * truth.translation};
}

TEST(Neighbours, GetPointsWithMetricDepth) {
  TwoViews world = make_two_views({.with_points = true});
  const std::vector<std::optional<Eigen::Vector3d>> truth = world.match.points_in_camera;
  world.match = make_view(world.match.frame, world.match.camera, world.match.features);
  const auto link = link_neighbours(world.match, world.query, world.match_from_query);
  ASSERT_TRUE(link.has_value());
  EXPECT_EQ(link->previous, world.match.frame);
  EXPECT_LT((link->previous_from_current.translation - world.match_from_query.translation).norm(), 1e-4);
  EXPECT_GT(link->num_points, 150);  // of 200; the others have too little parallax
  EXPECT_EQ(count_points(world.match), static_cast<std::size_t>(link->num_points));
  EXPECT_EQ(count_points(world.query), static_cast<std::size_t>(link->num_points));
  // Keypoints are floats: 3e-5 px over 500 px, 14 m away under 1 degree of parallax at least.
  constexpr double kExactStepM = 5e-3;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto& in_match = world.match.points_in_camera[i];
    const auto& in_query = world.query.points_in_camera[i];
    EXPECT_EQ(in_match.has_value(), in_query.has_value());
    if (!in_match || !in_query) continue;
    EXPECT_LT((*in_match - *truth[i]).norm(), kExactStepM);
    EXPECT_LT((world.match_from_query * *in_query - *truth[i]).norm(), kExactStepM);
  }
}

TEST(Neighbours, TheOdometrysLengthIsTheUnit) {
  TwoViews world = make_two_views({.with_points = true});
  const std::vector<std::optional<Eigen::Vector3d>> truth = world.match.points_in_camera;
  world.match = make_view(world.match.frame, world.match.camera, world.match.features);
  const Pose doubled{world.match_from_query.rotation, 2 * world.match_from_query.translation};
  ASSERT_TRUE(link_neighbours(world.match, world.query, doubled).has_value());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto& point = world.match.points_in_camera[i];
    if (!point) continue;
    EXPECT_LT((*point - 2 * *truth[i]).norm(), 1e-2);
  }
}

TEST(Neighbours, TheImagesCorrectTheOdometrysAngles) {
  TwoViews world = make_two_views({.noise_px = 0.3});
  const Pose odometry = with_direction_turned(turned(world.match_from_query, 3), 5);
  const auto link = link_neighbours(world.match, world.query, odometry);
  ASSERT_TRUE(link.has_value());
  EXPECT_NEAR(link->rotation_error_deg, 3, 0.3);
  EXPECT_GT(link->direction_error_deg, 2);
  EXPECT_LT(deg_from_rad(link->previous_from_current.rotation.angularDistance(world.match_from_query.rotation)), 0.3);
  EXPECT_NEAR(link->previous_from_current.translation.norm(), odometry.translation.norm(), 1e-9);
}

TEST(Neighbours, OdometryThatContradictsTheImagesGivesNone) {
  for (const double degrees : {30.0, 90.0}) {
    TwoViews world = make_two_views({.noise_px = 0.3});
    EXPECT_FALSE(link_neighbours(world.match, world.query, turned(world.match_from_query, degrees)).has_value());
    EXPECT_EQ(count_points(world.match) + count_points(world.query), 0U);
  }
  TwoViews world = make_two_views({.noise_px = 0.3});
  const Pose backwards{world.match_from_query.rotation, -world.match_from_query.translation};
  EXPECT_FALSE(link_neighbours(world.match, world.query, backwards).has_value());
}

TEST(Neighbours, WithoutParallaxThereIsNone) {
  TwoViews world = make_two_views({.noise_px = 0.3, .baseline = 0.02});
  EXPECT_FALSE(link_neighbours(world.match, world.query, world.match_from_query).has_value());
  EXPECT_EQ(count_points(world.match) + count_points(world.query), 0U);
}

TEST(Neighbours, AStandstillGivesNone) {
  TwoViews world = make_two_views({});
  EXPECT_FALSE(link_neighbours(world.match, world.query, {}).has_value());
}

TEST(Neighbours, FewSharedFeaturesGiveNone) {
  TwoViews world = make_two_views({.num_points = 20});
  EXPECT_FALSE(link_neighbours(world.match, world.query, world.match_from_query).has_value());
}

TEST(Neighbours, InformationSaysNothingOfTheLength) {
  TwoViews world = make_two_views({.noise_px = 0.3});
  const auto link = link_neighbours(world.match, world.query, world.match_from_query);
  ASSERT_TRUE(link.has_value());
  const Eigen::Vector3d along = link->previous_from_current.rotation.conjugate() * link->previous_from_current.translation;
  const Eigen::Matrix3d information = link->information.topLeftCorner<3, 3>();
  EXPECT_GT(information.trace(), 0);
  EXPECT_LT((information * along.normalized()).norm(), 1e-9 * information.trace());
}

TEST(Neighbours, OnlyADistanceThatTheOdometryHardlyKnowsHasAUnitSigma) {
  const TwoViews world = make_two_views({});
  const auto unit_sigma_with = [&](double nearest_sigma, double sigma) {
    const std::vector<RecentView> recent = {{&world.match, world.match_from_query, nearest_sigma},
                                            {&world.match, world.match_from_query, sigma}};
    const auto found = see_recent(recent, world.query, 2);
    EXPECT_EQ(found.size(), 2U);
    EXPECT_EQ(found.at(0).unit_sigma, 0.0) << "the nearest view tells the unit, however vaguely";
    return found.at(1).unit_sigma;
  };
  EXPECT_EQ(unit_sigma_with(0.05, 0.05), 0.0);
  EXPECT_EQ(unit_sigma_with(0.05, 0.14), 0.14);
  EXPECT_EQ(unit_sigma_with(0.14, 0.14), 0.0);
}

TEST(Neighbours, AStandstillIsNoStepWhoseDistanceIsKnown) {
  const TwoViews world = make_two_views({});
  const Pose standing{world.match_from_query.rotation, Eigen::Vector3d::Zero()};
  for (const double sigma : {std::numeric_limits<double>::infinity(), 3.0}) {
    const std::vector<RecentView> recent = {{&world.match, standing, sigma},
                                            {&world.match, world.match_from_query, 0.05},
                                            {&world.match, world.match_from_query, 0.14}};
    const auto found = see_recent(recent, world.query, 3);
    ASSERT_EQ(found.size(), 2U) << "a standstill shows no direction";
    EXPECT_EQ(found[0].unit_sigma, 0.0);
    EXPECT_EQ(found[1].unit_sigma, 0.14);
  }
}

TEST(Neighbours, DepthsOfAVagueUnitGiveWayToOthers) {
  TwoViews world = make_two_views({});
  const auto seen = see_neighbour(world.match, world.query, world.match_from_query);
  const auto stretched =
      see_neighbour(world.match, world.query, {world.match_from_query.rotation, 1.3 * world.match_from_query.translation});
  ASSERT_TRUE(seen && stretched);
  View first = world.match, second = world.query;
  give_depths(first, second, {0, *stretched, 0.14});
  EXPECT_EQ(second.unit_sigma, 0.14);
  EXPECT_EQ(count_points(second), stretched->points.size()) << "better than none";
  give_depths(first, second, {0, *seen});
  View only_first = world.match, only_second = world.query;
  give_depths(only_first, only_second, {0, *seen});
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(second.unit_sigma, 0.0);
    EXPECT_EQ(second.points_in_camera, only_second.points_in_camera);
    EXPECT_EQ(first.points_in_camera, only_first.points_in_camera);
    give_depths(first, second, {0, *stretched, 0.14});  // too late to count
  }
}

}  // namespace
}  // namespace fabloop
