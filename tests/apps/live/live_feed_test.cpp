// SPDX-License-Identifier: BSD-3-Clause
#include "apps/live/live_feed.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "apps/live/live_pages.h"

namespace fabloop::apps {
namespace {

LiveMap two_frames() {
  LiveMap map;
  map.placed = {{0, {0, 0, 0}}, {1, {1, 0, 0}}};
  return map;
}

TEST(LiveFeed, SnapshotsNeverChange) {
  LiveFeed feed;
  const auto before = feed.latest();
  feed.tell_progress("features", 1, 10);
  feed.show(two_frames());
  EXPECT_TRUE(before->stages.empty());
  EXPECT_TRUE(before->map->placed.empty());
  EXPECT_EQ(feed.latest()->map->placed.size(), 2U);
  EXPECT_EQ(feed.latest()->run, before->run);
}

TEST(LiveFeed, AStageThatComesAgainKeepsItsTime) {
  LiveFeed feed;
  feed.tell_progress("placing", 3, 10);
  feed.tell_progress("adjust", 0, 0);
  feed.tell_progress("placing", 4, 10);
  const auto snapshot = feed.latest();
  ASSERT_EQ(snapshot->stages.size(), 2U);
  EXPECT_EQ(snapshot->stages.back().name, "placing");
  EXPECT_EQ(snapshot->stages.back().done, 4U);
  EXPECT_GT(snapshot->stages.back().seconds_before, 0.0);
}

TEST(LiveFeed, TheLastStepOfAStageIsAlwaysTold) {
  LiveFeed feed;
  for (std::size_t done = 1; done <= 1000; ++done) feed.tell_progress("features", done, 1000);
  EXPECT_EQ(feed.latest()->stages.back().done, 1000U);
}

TEST(LiveFeed, IsReadWhileItIsWritten) {
  LiveFeed feed;
  std::atomic<bool> is_over = false;
  std::thread reader([&] {
    std::uint64_t last = 0;
    while (!is_over) {
      const auto snapshot = feed.latest();
      EXPECT_GE(snapshot->map->last_change, last);
      last = snapshot->map->last_change;
    }
  });
  LiveMap map;
  for (std::size_t frame = 0; frame < 300; ++frame) {
    map.placed.push_back({frame, {static_cast<double>(frame), 0, 0}});
    feed.show(map);
    feed.tell_progress("mapping", frame + 1, 300);
  }
  feed.end("run/report.html");
  is_over = true;
  reader.join();
  EXPECT_EQ(feed.latest()->state, LiveState::Ended);
}

TEST(LivePages, ThoseThatAskedLatelyAreWaitedFor) {
  LivePages pages;
  const LiveClock::time_point now = LiveClock::now();
  EXPECT_FALSE(pages.is_any_waiting(now));
  pages.answered("a", LiveState::Running, false, now);
  EXPECT_TRUE(pages.is_any_waiting(now));
  EXPECT_FALSE(pages.is_any_waiting(now + std::chrono::seconds(10))) << "it was closed";
  pages.answered("a", LiveState::Ended, true, now);
  EXPECT_TRUE(pages.is_any_waiting(now)) << "the report is still to come";
  pages.got_report("a");
  EXPECT_FALSE(pages.is_any_waiting(now));
  pages.answered("b", LiveState::Failed, false, now);
  EXPECT_FALSE(pages.is_any_waiting(now));
}

}  // namespace
}  // namespace fabloop::apps
