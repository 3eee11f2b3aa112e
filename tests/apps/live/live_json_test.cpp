// SPDX-License-Identifier: BSD-3-Clause
#include "apps/live/live_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <vector>

namespace fabloop::apps {
namespace {

/// A run of so many keyframes with ten hypotheses each, on a spiral.
LiveMap long_run(std::size_t num_frames, double scale = 1.0) {
  LiveMap map;
  for (std::size_t frame = 0; frame < num_frames; ++frame) {
    const double angle = 0.01 * static_cast<double>(frame);
    const Eigen::Vector3d x = scale * Eigen::Vector3d(angle * std::cos(angle), angle * std::sin(angle), 1.0 / 3.0);
    map.placed.push_back({frame, x});
    map.odometry.push_back({frame, x});
    for (std::size_t i = 0; i < 10 && i < frame; ++i) map.loops.push_back({frame, i, Verdict::TooFewInliers, 7});
  }
  return map;
}

TEST(LiveJson, SaysWhereTheRunIs) {
  LiveFeed feed;
  feed.tell_progress("features", 25, 25);
  feed.tell_progress("mapping", 2, 25);
  LiveMap map = long_run(20);
  map.loops.back().verdict = Verdict::Accepted;
  map.loops.front().verdict = Verdict::Unconfirmed;
  map.newest = 19;
  feed.show(map);
  const auto json = live_json(*feed.latest(), 0, LiveClock::now());
  EXPECT_EQ(json.at("run"), feed.latest()->run);
  EXPECT_EQ(json.at("state"), "running");
  ASSERT_EQ(json.at("stages").size(), 2U);
  EXPECT_EQ(json.at("stages").at(1).at("name"), "mapping");
  EXPECT_EQ(json.at("stages").at(1).at("total"), 25);
  EXPECT_GT(json.at("elapsed_s"), 0.0);
  EXPECT_EQ(json.at("counts").at("placed"), 20);
  EXPECT_EQ(json.at("counts").at("accepted"), 1);
  EXPECT_EQ(json.at("counts").at("held_back"), 1);
  EXPECT_EQ(json.at("newest"), 19);
  EXPECT_EQ(json.at("placed").size(), 4U * 20U);
  EXPECT_EQ(json.at("loops").size(), 5U * map.loops.size());
  EXPECT_FALSE(json.at("more"));
}

TEST(LiveJson, SendsOnlyWhatIsNew) {
  LiveFeed feed;
  feed.show(long_run(20));
  const std::uint64_t since = live_json(*feed.latest(), 0, LiveClock::now()).at("since");
  feed.show(long_run(21));
  const auto json = live_json(*feed.latest(), since, LiveClock::now());
  EXPECT_EQ(json.at("placed").size(), 4U);
  EXPECT_EQ(json.at("placed").at(0), 20);
  EXPECT_EQ(json.at("odometry").size(), 4U);
  EXPECT_EQ(json.at("loops").size(), 5U * 10U);
  EXPECT_EQ(live_json(*feed.latest(), json.at("since"), LiveClock::now()).at("placed").size(), 0U);
}

TEST(LiveJson, ALongRunComesInBoundedAnswersAndWhole) {
  constexpr std::size_t kFrames = 10000;
  LiveFeed feed;
  feed.show(long_run(kFrames, 50.0));
  std::map<int, int> placed, rows;
  std::uint64_t since = 0;
  std::size_t num_answers = 0, largest = 0;
  for (bool more = true; more; ++num_answers) {
    const auto json = live_json(*feed.latest(), since, LiveClock::now());
    largest = std::max(largest, json.dump().size());
    for (std::size_t i = 0; i < json.at("placed").size(); i += 4) ++placed[json.at("placed").at(i)];
    for (std::size_t i = 0; i < json.at("loops").size(); i += 5) ++rows[json.at("loops").at(i)];
    since = json.at("since");
    more = json.at("more");
  }
  EXPECT_EQ(placed.size(), kFrames);
  EXPECT_EQ(rows.size(), feed.latest()->map->loops.size());
  for (const auto& [row, times] : rows) ASSERT_EQ(times, 1) << row;
  EXPECT_LT(largest, 150'000U);
  EXPECT_LT(num_answers, 40U);
}

TEST(LiveJson, PositionsHaveTheDigitsThatAreSeen) {
  LiveFeed feed;
  feed.show(long_run(100, 1e-3));
  const auto small = live_json(*feed.latest(), 0, LiveClock::now()).at("placed");
  for (const auto& value : small) EXPECT_LE(value.dump().size(), 12U);
  LiveFeed large;
  large.show(long_run(100, 1e6));
  const auto placed = live_json(*large.latest(), 0, LiveClock::now()).at("placed");
  EXPECT_NEAR(placed.at(3).get<double>(), 1e6 / 3.0, 100.0);
}

TEST(LiveJson, ANumberOfAnotherRunStartsAnew) {
  LiveFeed feed;
  feed.show(long_run(20));
  EXPECT_EQ(live_json(*feed.latest(), 1'000'000, LiveClock::now()).at("placed").size(), 4U * 20U);
}

TEST(LiveJson, TimeStandsStillAtTheEnd) {
  LiveFeed feed;
  feed.tell_progress("mapping", 1, 2);
  feed.fail("a disk is full");
  const auto now = LiveClock::now();
  const auto json = live_json(*feed.latest(), 0, now), later = live_json(*feed.latest(), 0, now + std::chrono::hours(1));
  EXPECT_EQ(json.at("state"), "failed");
  EXPECT_EQ(json.at("why"), "a disk is full");
  EXPECT_EQ(json, later);
}

}  // namespace
}  // namespace fabloop::apps
