// SPDX-License-Identifier: BSD-3-Clause
#include "verification/async_loop_closer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <string>
#include <thread>

#include "frontend/error.h"
#include "tests/verification/event_text.h"
#include "tests/verification/two_view_world.h"
#include "tests/verification/walk_world.h"

namespace fabloop {
namespace {

using testing::ElementsAre;
using testing_support::keyframe_of;
using testing_support::make_walk;
using testing_support::test_camera;
using testing_support::text_of;
using testing_support::Walk;

const Walk& short_walk() {
  static const Walk walk = make_walk({.num_landmarks = 1500, .num_frames = 18, .num_again = 4});
  return walk;
}

LoopCloser make_closer() {
  LoopCloserOptions options;
  options.hypotheses.num_recent_excluded = 8;
  options.hypotheses.max_hypotheses = 2;
  options.num_threads = 1;
  return {test_camera(), short_walk().model, options};
}

Keyframe frame(std::size_t i) { return keyframe_of(short_walk(), i); }

std::vector<std::string> synchronous_events() {
  LoopCloser closer = make_closer();
  std::vector<std::string> events;
  for (std::size_t i = 0; i < short_walk().features.size(); ++i) events.push_back(text_of(closer.add_keyframe(frame(i))));
  return events;
}

/// Holds the worker in the callback of its first result until it is let go, so that the queue fills as the test wants.
class HeldWorker {
 public:
  explicit HeldWorker(AsyncOptions options) : async_(make_closer(), with_callback(std::move(options))) {
    async_.submit(frame(0));
    is_held_.get_future().wait();
  }
  ~HeldWorker() { let_go(); }
  HeldWorker(const HeldWorker&) = delete;
  HeldWorker& operator=(const HeldWorker&) = delete;

  AsyncLoopCloser& operator*() { return async_; }
  AsyncLoopCloser* operator->() { return &async_; }

  /// Lets the worker go on; returns the frames that it has processed in the end.
  std::vector<std::size_t> finish() {
    let_go();
    async_.flush();
    return frames_;
  }
  void let_go() {
    if (!std::exchange(was_let_go_, true)) may_go_.set_value();
  }

 private:
  AsyncOptions with_callback(AsyncOptions options) {
    options.on_result = [this](const AsyncResult& result) {
      frames_.push_back(result.frame - 100);
      if (frames_.size() > 1) return;
      is_held_.set_value();
      may_go_.get_future().wait();
    };
    return options;
  }

  std::promise<void> is_held_, may_go_;
  bool was_let_go_ = false;
  std::vector<std::size_t> frames_;
  AsyncLoopCloser async_;
};

TEST(AsyncLoopCloser, GivesTheEventsOfTheSynchronousOne) {
  AsyncLoopCloser async(make_closer(), {.max_queue = 3});
  for (std::size_t i = 0; i < short_walk().features.size(); ++i) EXPECT_TRUE(async.submit(frame(i)));
  std::vector<std::string> events;
  while (const auto result = async.wait_next()) events.push_back(text_of(result->get()));
  EXPECT_EQ(events, synchronous_events());
  const AsyncStatistics statistics = async.statistics();
  EXPECT_EQ(statistics.num_submitted, events.size());
  EXPECT_EQ(statistics.num_processed, events.size());
  EXPECT_EQ(statistics.num_failed + statistics.num_dropped + statistics.num_rejected + statistics.num_cancelled, 0U);
  EXPECT_LE(statistics.max_queue_length, 3U);
  EXPECT_EQ(statistics.latency.count, events.size());
  EXPECT_LE(statistics.latency.p50_ms, statistics.latency.p99_ms);
  EXPECT_LE(statistics.latency.p99_ms, statistics.latency.max_ms);
}

TEST(AsyncLoopCloser, CallsBackInOrderWithTheSameEvents) {
  std::vector<std::string> events;
  AsyncLoopCloser async(make_closer(), {.on_result = [&](const AsyncResult& r) { events.push_back(text_of(r.get())); }});
  for (std::size_t i = 0; i < short_walk().features.size(); ++i) async.submit(frame(i));
  async.flush();
  EXPECT_EQ(events, synchronous_events());
  EXPECT_FALSE(async.poll().has_value()) << "results go to the callback alone";
}

TEST(AsyncLoopCloser, AnExceptionIsTheResultOfItsKeyframe) {
  AsyncLoopCloser async(make_closer());
  Keyframe bad = frame(1);
  bad.features.reset();
  async.submit(frame(0));
  async.submit(bad);
  async.submit(frame(2));
  async.flush();
  EXPECT_NO_THROW(async.poll()->get());
  const auto failed = async.poll();
  EXPECT_EQ(failed->frame, 101U);
  EXPECT_FALSE(failed->event.has_value());
  EXPECT_THROW(failed->get(), InputError);
  EXPECT_NO_THROW(async.poll()->get());
  EXPECT_EQ(async.statistics().num_failed, 1U);
  EXPECT_EQ(async.statistics().num_processed, 3U);
}

TEST(AsyncLoopCloser, RejectsWhatFindsNoRoom) {
  HeldWorker held({.max_queue = 2, .back_pressure = BackPressure::Reject});
  EXPECT_TRUE(held->submit(frame(1)));
  EXPECT_TRUE(held->submit(frame(2)));
  EXPECT_FALSE(held->submit(frame(3)));
  EXPECT_THAT(held.finish(), ElementsAre(0, 1, 2));
  EXPECT_EQ(held->statistics().num_submitted, 3U);
  EXPECT_EQ(held->statistics().num_rejected, 1U);
  EXPECT_EQ(held->statistics().max_queue_length, 2U);
  EXPECT_TRUE(held->submit(frame(4))) << "there is room again";
}

TEST(AsyncLoopCloser, DropsTheOldestForTheNewest) {
  HeldWorker held({.max_queue = 2, .back_pressure = BackPressure::DropOldest});
  for (std::size_t i = 1; i < 6; ++i) EXPECT_TRUE(held->submit(frame(i)));
  EXPECT_THAT(held.finish(), ElementsAre(0, 4, 5));
  EXPECT_EQ(held->statistics().num_submitted, 6U);
  EXPECT_EQ(held->statistics().num_dropped, 3U);
  EXPECT_EQ(held->statistics().num_processed, 3U);
}

TEST(AsyncLoopCloser, ACovarianceThatCountsFromALostKeyframeIsNotUsed) {
  HeldWorker held({.max_queue = 2, .back_pressure = BackPressure::DropOldest});
  for (std::size_t i = 1; i < 4; ++i) {
    Keyframe keyframe = frame(i);
    keyframe.step_covariance.emplace().setIdentity();
    held->submit(keyframe);
  }
  EXPECT_THAT(held.finish(), ElementsAre(0, 2, 3));
  const auto& keyframes = held->loop_closer().map().keyframes;
  EXPECT_FALSE(keyframes[1].step_covariance.has_value()) << "a step from the one that was dropped";
  EXPECT_TRUE(keyframes[2].step_covariance.has_value());
}

TEST(AsyncLoopCloser, BlocksUntilThereIsRoom) {
  HeldWorker held({.max_queue = 1});
  held->submit(frame(1));
  std::thread host([&] {
    for (std::size_t i = 2; i < 6; ++i) EXPECT_TRUE(held->submit(frame(i)));
  });
  held.let_go();
  host.join();
  EXPECT_THAT(held.finish(), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_EQ(held->statistics().max_queue_length, 1U);
}

TEST(AsyncLoopCloser, CancelEmptiesTheQueueAndCounts) {
  HeldWorker held({.max_queue = 3});
  for (std::size_t i = 1; i < 4; ++i) held->submit(frame(i));
  EXPECT_EQ(held->cancel(), 3U);
  EXPECT_THAT(held.finish(), ElementsAre(0)) << "the one at hand is finished";
  EXPECT_EQ(held->statistics().num_cancelled, 3U);
  held->submit(frame(4));
  EXPECT_THAT(held.finish(), ElementsAre(0, 4)) << "it goes on afterwards";
}

TEST(AsyncLoopCloser, ADestructorCancelsAndJoins) {
  AsyncLoopCloser async(make_closer());
  for (std::size_t i = 0; i < 8; ++i) async.submit(frame(i));
}

TEST(AsyncLoopCloser, WaitingForNothingReturnsAtOnce) {
  AsyncLoopCloser async(make_closer());
  EXPECT_FALSE(async.wait_next().has_value());
  EXPECT_FALSE(async.poll().has_value());
  async.flush();
  EXPECT_EQ(async.cancel(), 0U);
}

TEST(AsyncLoopCloser, WhatTheCallbackThrowsComesOutOfFlush) {
  AsyncLoopCloser async(make_closer(), {.on_result = [](const AsyncResult& result) {
                          if (result.frame == 100) throw std::runtime_error("the disk is full");
                        }});
  async.submit(frame(0));
  async.submit(frame(1));
  EXPECT_THROW(async.flush(), std::runtime_error);
  EXPECT_NO_THROW(async.flush()) << "once";
  EXPECT_EQ(async.statistics().num_processed, 2U);
}

TEST(AsyncLoopCloser, TakesKeyframesFromManyThreads) {
  AsyncLoopCloser async(make_closer(), {.max_queue = 2, .back_pressure = BackPressure::Reject});
  std::vector<std::thread> hosts;
  for (std::size_t host = 0; host < 3; ++host) {
    hosts.emplace_back([&async, host] {
      for (std::size_t i = host; i < 12; i += 3) async.submit(frame(i));
      async.poll();
      async.statistics();
    });
  }
  for (std::thread& host : hosts) host.join();
  async.flush();
  const AsyncStatistics statistics = async.statistics();
  EXPECT_EQ(statistics.num_submitted + statistics.num_rejected, 12U);
  EXPECT_EQ(statistics.num_processed, statistics.num_submitted) << "those out of order fail, and none is lost";
}

TEST(AsyncLoopCloser, AQueueWithoutRoomIsRefused) { EXPECT_THROW(AsyncLoopCloser(make_closer(), {.max_queue = 0}), InputError); }

TEST(AsyncLoopCloser, CopiesTheBuffersOfTheHost) {
  HeldWorker held({});
  Keyframe keyframe = frame(1);
  keyframe.features->descriptors = keyframe.features->descriptors.clone();
  held->submit(keyframe);
  keyframe.features->descriptors.setTo(0);
  held.finish();
  const cv::Mat& kept = held->loop_closer().map().keyframes[1].view.features.descriptors;
  EXPECT_EQ(cv::norm(kept, short_walk().features[1].descriptors), 0.0);
}

}  // namespace
}  // namespace fabloop
