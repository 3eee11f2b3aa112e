// SPDX-License-Identifier: BSD-3-Clause
#include "apps/live/live_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

namespace fabloop::apps {
namespace {

/// Frames along a circle, every `step`-th of so many.
LiveMap circle(std::size_t num_frames, std::size_t step = 1) {
  LiveMap map;
  for (std::size_t i = 0; i < num_frames; i += step) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(num_frames);
    map.placed.push_back({i, {100.0 * std::cos(angle), 100.0 * std::sin(angle), 0.0}});
  }
  return map;
}

TEST(LiveMap, OnlyWhatMovesVisiblyHasANewNumber) {
  const LiveMap first = numbered({}, circle(100));
  EXPECT_EQ(first.last_change, 100U);
  LiveMap now = circle(100);
  now.placed[10].x_in_world.x() += 0.01;  // of 200 m
  now.placed[20].x_in_world.x() += 1.0;
  const LiveMap second = numbered(first, now);
  EXPECT_EQ(second.last_change, 101U);
  EXPECT_EQ(second.placed[20].changed, 101U);
  EXPECT_EQ(second.placed[10].changed, first.placed[10].changed);
  EXPECT_EQ(second.world, first.world);
}

TEST(LiveMap, SmallMovesAddUpUntilTheyAreSeen) {
  LiveMap map = numbered({}, circle(100));
  const std::uint64_t before = map.last_change;
  for (int i = 1; i <= 10; ++i) {
    LiveMap now = circle(100);
    now.placed[10].x_in_world.x() += 0.01 * i;
    map = numbered(map, now);
  }
  EXPECT_GT(map.last_change, before);
  EXPECT_NEAR(map.placed[10].x_in_world.x(), circle(100).placed[10].x_in_world.x() + 0.1, 2e-4 * 200.0);
}

TEST(LiveMap, FramesThatComeInBetweenAreAdded) {
  const LiveMap half = numbered({}, circle(100, 2));
  const LiveMap whole = numbered(half, circle(100));
  EXPECT_EQ(whole.world, half.world);
  EXPECT_EQ(whole.last_change, half.last_change + 50);
  for (std::size_t frame = 0; frame < 100; frame += 2) EXPECT_EQ(whole.placed[frame].changed, half.placed[frame / 2].changed);
}

TEST(LiveMap, FramesThatLostTheirPlacesMakeAnotherWorld) {
  const LiveMap whole = numbered({}, circle(100));
  const LiveMap half = numbered(whole, circle(100, 2));
  EXPECT_EQ(half.world, whole.world + 1);
  for (const LivePosition& position : half.placed) EXPECT_GT(position.changed, whole.last_change);
}

TEST(LiveMap, AVerdictThatChangesHasANewNumber) {
  LiveMap now = circle(10);
  now.loops = {{8, 0, Verdict::Unconfirmed, 50}, {9, 1, Verdict::TooFewInliers, 3}};
  const LiveMap first = numbered({}, now);
  now.loops[0].verdict = Verdict::Accepted;
  const LiveMap second = numbered(first, now);
  EXPECT_EQ(second.loops[0].changed, second.last_change);
  EXPECT_EQ(second.loops[1].changed, first.loops[1].changed);
}

TEST(LiveMap, TheVerticalIsAcrossThePathAndKeepsStill) {
  EXPECT_EQ(numbered({}, circle(100)).up, Eigen::Vector3d::UnitZ());
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.9, Eigen::Vector3d::UnitX()).toRotationMatrix();
  LiveMap tilted = circle(100);
  for (LivePosition& position : tilted.placed) position.x_in_world = turn * position.x_in_world;
  const LiveMap first = numbered({}, tilted);
  EXPECT_NEAR(first.up.dot(turn.col(2)), 1.0, 1e-9);
  for (LivePosition& position : tilted.placed) position.x_in_world.z() *= 1.05;
  EXPECT_EQ(numbered(first, tilted).up, first.up);
}

}  // namespace
}  // namespace fabloop::apps
