// SPDX-License-Identifier: BSD-3-Clause
#include "data/aliasing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "frontend/error.h"

namespace fabloop {
namespace {

constexpr double kPixelM = 0.5;

/// 100 x 100 m of noise: no two places look alike, and heights tell them apart too. The bare ground rises to the east.
World noisy_world() {
  World world;
  world.texture_m_per_px = kPixelM;
  world.texture.emplace_back(200, 200);
  cv::RNG random(3);
  random.fill(world.texture[0], cv::RNG::UNIFORM, 0, 256);
  update_texture_levels(world);
  world.terrain = {world.area.min, 1.0, cv::Mat1f(101, 101), {}, 0};
  world.surface = {world.area.min, kPixelM, cv::Mat1f(201, 201), {}, 0};
  random.fill(world.surface.heights, cv::RNG::UNIFORM, 0, 5);
  for (int col = 0; col < 101; ++col) world.terrain.heights.col(col) = 0.1F * static_cast<float>(col);
  for (int col = 0; col < 201; ++col) world.surface.heights.col(col) += 0.05 * col;
  update_block_max(world.terrain);
  update_block_max(world.surface);
  return world;
}

/// The pixels of a tile's inside, beyond its faded border. Tiles are 10 m, ten a row.
cv::Rect inside_of(std::size_t tile) {
  constexpr int kTilePx = 20, kBorderPx = 5;
  return {static_cast<int>(tile % 10) * kTilePx + kBorderPx, static_cast<int>(tile / 10) * kTilePx + kBorderPx,
          kTilePx - 2 * kBorderPx, kTilePx - 2 * kBorderPx};
}

double difference(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_L1); }

TEST(Aliasing, TheShareOfCopiesIsTheOneAskedFor) {
  for (const double share : {0.1, 0.3, 0.6}) {
    World world = noisy_world();
    const World before = noisy_world();
    const AliasedGround ground = alias_ground(world, {.share = share, .tile_m = 10});
    EXPECT_NEAR(ground.share(), share, 1e-12) << "a hundred tiles can meet it";
    std::size_t num_changed = 0;
    for (std::size_t tile = 0; tile < 100; ++tile)
      num_changed += difference(world.texture[0](inside_of(tile)), before.texture[0](inside_of(tile))) > 0;
    EXPECT_EQ(num_changed, ground.copies.size());
  }
}

TEST(Aliasing, CopiesLookLikeOtherGroundAndRiseAsItDoes) {
  World world = noisy_world();
  const World before = noisy_world();
  const AliasedGround ground = alias_ground(world, {.share = 0.3, .tile_m = 10});
  std::set<std::size_t> tiles;
  for (const auto& [tile, source] : ground.copies) tiles.insert(tile);
  for (const auto& [tile, source] : ground.copies) {
    EXPECT_FALSE(tiles.contains(source)) << "a copy of a copy";
    EXPECT_EQ(difference(world.texture[0](inside_of(tile)), before.texture[0](inside_of(source))), 0.0);
    EXPECT_EQ(difference(world.texture[0](inside_of(source)), before.texture[0](inside_of(source))), 0.0);
    const cv::Rect here = inside_of(tile), there = inside_of(source);
    for (int i = 0; i < here.width; ++i) {
      const double x = -50 + (here.x + i) * kPixelM, y = -50 + here.y * kPixelM;
      const double relief = world.surface.heights(here.y, here.x + i) - height_at(world.terrain, x, y);
      const double source_x = -50 + (there.x + i) * kPixelM, source_y = -50 + there.y * kPixelM;
      EXPECT_NEAR(relief, before.surface.heights(there.y, there.x + i) - height_at(before.terrain, source_x, source_y), 1e-4);
    }
  }
  double highest = 0.0;
  cv::minMaxLoc(world.surface.heights, nullptr, &highest);
  EXPECT_EQ(world.surface.max_height, highest) << "rays would pass through what was copied";
}

TEST(Aliasing, MoreOfItCopiesTheSameTilesAndMore) {
  const auto tiles_at = [](double share) {
    World world = noisy_world();
    std::set<std::size_t> tiles;
    for (const auto& [tile, source] : alias_ground(world, {.seed = 4, .share = share, .tile_m = 10}).copies) tiles.insert(tile);
    return tiles;
  };
  const std::set<std::size_t> few = tiles_at(0.2), many = tiles_at(0.5);
  EXPECT_TRUE(std::includes(many.begin(), many.end(), few.begin(), few.end()));
}

TEST(Aliasing, TheSeedDecidesWhichTilesAreCopies) {
  const auto copies_of = [](std::uint64_t seed) {
    World world = noisy_world();
    return alias_ground(world, {.seed = seed, .share = 0.3, .tile_m = 10}).copies;
  };
  EXPECT_EQ(copies_of(1), copies_of(1));
  EXPECT_NE(copies_of(1), copies_of(2));
}

TEST(Aliasing, WithoutAShareNothingChanges) {
  World world = noisy_world();
  EXPECT_TRUE(alias_ground(world, {.share = 0.0}).copies.empty());
  EXPECT_EQ(difference(world.texture[0], noisy_world().texture[0]), 0.0);
}

TEST(Aliasing, BadOptionsAreRefused) {
  World world = noisy_world();
  EXPECT_THROW(alias_ground(world, {.share = 1.0}), InputError);
  EXPECT_THROW(alias_ground(world, {.share = -0.1}), InputError);
  EXPECT_THROW(alias_ground(world, {.share = 0.5, .tile_m = 1000}), InputError);
  EXPECT_THROW(alias_ground(world, {.share = 0.5, .tile_m = 1}), InputError);
}

}  // namespace
}  // namespace fabloop
