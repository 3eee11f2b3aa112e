// SPDX-License-Identifier: BSD-3-Clause
#include "data/world.h"

#include <gtest/gtest.h>

#include "data/meadow.h"
#include "frontend/error.h"

namespace fabloop {
namespace {

/// A plane z = 0.1 x with a tower of 5 m over x, y in [10, 12].
HeightMap slope_with_tower() {
  HeightMap map;
  map.spacing_m = 0.5;
  map.heights.create(60, 60);
  for (int row = 0; row < 60; ++row) {
    for (int col = 0; col < 60; ++col) {
      const bool tower = row >= 20 && row <= 24 && col >= 20 && col <= 24;
      map.heights(row, col) = static_cast<float>(0.05 * col + (tower ? 5 : 0));
    }
  }
  update_block_max(map);
  return map;
}

/// intersect() refines until this.
constexpr double kHeightTolerance = 2e-3;

TEST(HeightMap, RaysMeetASlopeWhereGeometrySays) {
  const HeightMap map = slope_with_tower();
  const Eigen::Vector3d origin(2, 20, 12);
  const Eigen::Vector3d direction = Eigen::Vector3d(0.4, 0.1, -1).normalized();
  const auto distance = intersect(map, origin, direction);
  ASSERT_TRUE(distance.has_value());
  const Eigen::Vector3d point = origin + *distance * direction;
  EXPECT_NEAR(point.z(), 0.1 * point.x(), kHeightTolerance);
}

TEST(HeightMap, RaysStopAtTheFirstThingInTheirWay) {
  const HeightMap map = slope_with_tower();
  const Eigen::Vector3d origin(4, 11, 10);
  const Eigen::Vector3d direction = (Eigen::Vector3d(14, 11, 0) - origin).normalized();  // straight through the tower
  const auto distance = intersect(map, origin, direction);
  ASSERT_TRUE(distance.has_value());
  const double x = (origin + *distance * direction).x();
  EXPECT_GT(x, 9.4);
  EXPECT_LT(x, 10.1);
}

TEST(HeightMap, RaysUpwardsAndFromBelowMeetNothing) {
  const HeightMap map = slope_with_tower();
  EXPECT_FALSE(intersect(map, {5, 5, 10}, Eigen::Vector3d::UnitZ()).has_value());
  EXPECT_FALSE(intersect(map, {11, 11, 2}, -Eigen::Vector3d::UnitZ()).has_value());
}

TEST(HeightMap, GoesOnBeyondItsBorder) {
  const HeightMap map = slope_with_tower();
  EXPECT_NEAR(height_at(map, -100, 5), 0.0, 1e-6);
  EXPECT_TRUE(intersect(map, {-50, -50, 10}, -Eigen::Vector3d::UnitZ()).has_value());
}

TEST(Meadow, DoesNotDependOnTheNumberOfThreads) {
  const GroundArea area{{-20, -15}, {20, 15}};
  MeadowOptions options;
  options.texture_m_per_px = 0.25;
  options.height_m_per_px = 0.25;
  options.num_threads = 1;
  const World one = make_meadow(area, options);
  options.num_threads = 3;
  const World three = make_meadow(area, options);
  EXPECT_EQ(cv::norm(one.texture[0], three.texture[0], cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(one.surface.heights, three.surface.heights, cv::NORM_INF), 0);
  options.seed = 2;
  EXPECT_GT(cv::norm(one.texture[0], make_meadow(area, options).texture[0], cv::NORM_INF), 0);
}

TEST(Meadow, IsMostlyGrass) {
  MeadowOptions options;
  options.texture_m_per_px = 0.5;
  options.height_m_per_px = 0.5;
  const World world = make_meadow({{-60, -50}, {60, 50}}, options);
  int covered = 0;
  for (int row = 0; row < world.surface.heights.rows; ++row) {
    for (int col = 0; col < world.surface.heights.cols; ++col) {
      const double above = world.surface.heights(row, col) -
                           height_at(world.terrain, world.area.min.x() + 0.5 * col, world.area.min.y() + 0.5 * row);
      if (above > 0.5) ++covered;
    }
  }
  const double share = static_cast<double>(covered) / static_cast<double>(world.surface.heights.total());
  EXPECT_GT(share, 0.003);
  EXPECT_LT(share, 0.10);
}

TEST(Meadow, RefusesBadOptions) {
  EXPECT_THROW(make_meadow({{0, 0}, {1, 1}}), InputError);
  EXPECT_THROW(make_meadow({{0, 0}, {1e6, 1e6}}), InputError);
  MeadowOptions options;
  options.texture_m_per_px = 0;
  EXPECT_THROW(make_meadow({{0, 0}, {20, 20}}, options), InputError);
}

}  // namespace
}  // namespace fabloop
