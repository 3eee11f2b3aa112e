// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <random>

#include "frontend/error.h"
#include "posegraph/sfm/dense_surface.h"
#include "posegraph/sfm/semi_global.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/posegraph/sfm/bump_world.h"

namespace fabloop {
namespace {

using test::BumpWorld;
using test::ScratchFolder;

std::vector<Eigen::Vector3d> points_of(const Reconstruction& reconstruction) {
  std::vector<Eigen::Vector3d> points;
  for (const ScenePoint& point : reconstruction.points) points.push_back(point.x_in_world);
  return points;
}

/// Root mean square of the field's error over the middle of the world.
double rmse(const HeightField& field, const BumpWorld& world) {
  double sum = 0;
  int count = 0;
  for (double y = -8; y <= 8; y += 0.5) {
    for (double x = -10; x <= 10; x += 0.5, ++count) {
      const double error = height_at(field, {x, y}) - world.height_at(x, y);
      sum += error * error;
    }
  }
  return std::sqrt(sum / count);
}

TEST(GroundGrid, RowsGoSouthAndCoarserCellsCoverTheSameGround) {
  const GroundGrid grid = grid_over({10, 20}, {14, 23}, 0.5);
  EXPECT_EQ(grid.columns, 8);
  EXPECT_EQ(grid.rows, 6);
  EXPECT_EQ(grid.ground_at(0, 0), Eigen::Vector2d(10.25, 22.75));
  EXPECT_EQ(grid.position_of({10.25, 22.25}), Eigen::Vector2d(0, 1));
  const GroundGrid coarse = coarser(grid, 4);
  EXPECT_EQ(coarse.ground_at(-0.5, -0.5), grid.ground_at(-0.5, -0.5));
  EXPECT_EQ(coarse.columns, 2);
  EXPECT_EQ(coarse.rows, 2);
}

TEST(HeightField, FillingKeepsWhatIsKnownAndConstantsConstant) {
  std::mt19937 random(1);
  cv::Mat1f values(37, 53, 4.0F), weights(37, 53, 0.0F);
  for (int k = 0; k < 20; ++k) weights(static_cast<int>(random() % 37), static_cast<int>(random() % 53)) = 1;
  const cv::Mat1f constant = fill_smoothly(values, weights);
  EXPECT_LT(cv::norm(constant - 4.0F, cv::NORM_INF), 1e-5);
  for (float& value : values) value = static_cast<float>(random() % 100);
  const cv::Mat1f filled = fill_smoothly(values, weights);
  for (int row = 0; row < 37; ++row) {
    for (int column = 0; column < 53; ++column) {
      if (weights(row, column) > 0) {
        EXPECT_FLOAT_EQ(filled(row, column), values(row, column));
      }
      EXPECT_GE(filled(row, column), 0);
      EXPECT_LE(filled(row, column), 100);
    }
  }
}

TEST(HeightField, AWallHidesWhatIsBehindIt) {
  HeightField field{grid_over({-10, -10}, {10, 10}, 0.5), cv::Mat1f(40, 40, 0.0F), cv::Mat1f(40, 40, 1.0F)};
  field.heights.col(24).setTo(4);  // x from 2 to 2.5
  const double highest = 4;
  const Eigen::Vector3d camera(-8, 0, 8);
  EXPECT_TRUE(is_visible(field, highest, {1, 0, 0}, camera, 0.1));
  EXPECT_FALSE(is_visible(field, highest, {4, 0, 0}, camera, 0.1));
  // The ray over the wall's edge at (2.25, 4) reaches the ground where 8 / (x + 8) = 4 / (x - 2.25): x = 12.5 > 9.
  EXPECT_FALSE(is_visible(field, highest, {9, 0, 0}, camera, 0.1));
  EXPECT_TRUE(is_visible(field, highest, {4, 0, 0}, {4, 0, 8}, 0.1));
  EXPECT_FALSE(is_visible(field, highest, {4, 0, 0}, {4, 0, -8}, 0.1)) << "from below";
}

TEST(SemiGlobal, SmoothsAnOutlierAndKeepsAnEdge) {
  constexpr int kChoices = 8;
  CostVolume costs(9, 16, kChoices, 1.0F);
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 16; ++column) costs.at(row, column)[column < 8 ? 2 : 6] = 0;
  }
  costs.at(4, 3)[2] = 0.3F;
  costs.at(4, 3)[7] = 0;  // a wrong match, a little better than the right one
  const CostVolume sums = semi_global_sums(costs, 0.1F, 0.4F);
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 16; ++column)
      EXPECT_EQ(cheapest(sums, row, column), column < 8 ? 2 : 6) << row << ' ' << column;
  }
}

TEST(SparseSurface, LeavesWildPointsOut) {
  const ScratchFolder folder;
  const BumpWorld world;
  const Reconstruction reconstruction = world.reconstruction(folder.path());
  std::vector<Eigen::Vector3d> points = points_of(reconstruction);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-10, 10), wrong(3, 12);
  const std::size_t num_right = points.size();
  for (int k = 0; k < 30; ++k) points.emplace_back(place(random), place(random), (k % 2 == 0 ? 1 : -1) * wrong(random));
  const SparseSurface sparse = sparse_surface(points, ground_views(reconstruction, {}));
  EXPECT_GE(sparse.num_outliers, 27U);  // a few may lie where they are no worse than the hill's slope
  EXPECT_LE(sparse.num_outliers, 30U + num_right / 50);
  EXPECT_NEAR(sparse.flying_height, 20, 0.3);
  EXPECT_NEAR(sparse.ground_sampling, 0.2, 0.003);
  EXPECT_LT(rmse(sparse.field, world), 0.25);  // medians over cells of a few metres of a hill of two
}

TEST(DenseSurface, FindsAHillThatThePointsDoNotShow) {
  const ScratchFolder folder;
  const BumpWorld world;
  const Reconstruction reconstruction = world.reconstruction(folder.path());
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& x : points_of(reconstruction)) {
    if (x.head<2>().norm() > 9) points.push_back(x);  // flat ground around
  }
  const std::vector<GroundView> views = ground_views(reconstruction, {});
  SparseSurface sparse = sparse_surface(points, views);
  sparse.relief = 2;  // what a user knows of roofs that points do not show
  ASSERT_GT(rmse(sparse.field, world), 0.6);
  ImageCache images(reconstruction, 1 << 24);
  DenseSurfaceOptions options;
  options.coarsest_level = 1;
  const HeightField dense = dense_surface(sparse, views, images, options);
  // A third of a step (0.4 m) and the image noise of 8 bits; half a pixel of wrong convention would tilt or lift it by far more.
  EXPECT_LT(rmse(dense, world), 0.15);
  EXPECT_EQ(images.num_reads(), reconstruction.images.size());
}

TEST(ImageCache, KeepsWithinItsBudgetAndNamesWhatIsMissing) {
  const ScratchFolder folder;
  const BumpWorld world;
  Reconstruction reconstruction = world.reconstruction(folder.path());
  reconstruction.images.push_back(reconstruction.images.front());
  reconstruction.images.back().image_path = folder.path() / "missing.png";
  ImageCache one(reconstruction, 1);
  const auto held = one.get(0);
  one.get(1);
  one.get(0);
  EXPECT_EQ(one.num_reads(), 3U);
  EXPECT_EQ(held->grey[0].cols, world.width) << "what is held lives on";
  ImageCache all(reconstruction, 1 << 24);
  for (int round = 0; round < 3; ++round) {
    for (std::size_t i = 0; i < 9; ++i) all.get(i);
  }
  EXPECT_EQ(all.num_reads(), 9U);
  EXPECT_THROW(all.get(9), InputError);
}

}  // namespace
}  // namespace fabloop
