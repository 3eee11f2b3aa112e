// SPDX-License-Identifier: BSD-3-Clause
#include "apps/live/live_feed.h"

#include <algorithm>
#include <utility>

namespace fabloop::apps {
namespace {

// Pages ask once a second.
constexpr auto kProgressInterval = std::chrono::milliseconds(50);
constexpr auto kMapInterval = std::chrono::milliseconds(250);

double seconds_between(LiveClock::time_point begin, LiveClock::time_point end) {
  return std::chrono::duration<double>(end - begin).count();
}

/// The stage in which the run is now, last; the one before it has ended its turn.
LiveStage& turn_of(std::vector<LiveStage>& stages, std::string_view name, LiveClock::time_point now) {
  if (!stages.empty() && stages.back().name == name) return stages.back();
  if (!stages.empty()) stages.back().seconds_before += seconds_between(stages.back().began, now);
  auto known = std::find_if(stages.begin(), stages.end(), [&](const LiveStage& stage) { return stage.name == name; });
  if (known == stages.end()) {
    stages.push_back({std::string(name), 0, 0, 0.0, now});
  } else {
    std::rotate(known, known + 1, stages.end());
    stages.back().began = now;
  }
  return stages.back();
}

}  // namespace

LiveFeed::LiveFeed() {
  LiveSnapshot first;
  first.run = std::to_string(std::chrono::system_clock::now().time_since_epoch().count());
  first.began = LiveClock::now();
  first.map = std::make_shared<LiveMap>();
  latest_ = std::make_shared<LiveSnapshot>(std::move(first));
}

void LiveFeed::tell_progress(std::string_view stage, std::size_t done, std::size_t total) {
  const LiveClock::time_point now = LiveClock::now();
  const std::scoped_lock lock(mutex_);
  const bool is_same_stage = !latest_->stages.empty() && latest_->stages.back().name == stage;
  if (is_same_stage && done < total && now - told_ < kProgressInterval) return;
  told_ = now;
  LiveSnapshot next = *latest_;
  LiveStage& turn = turn_of(next.stages, stage, now);
  turn.done = done;
  turn.total = total;
  publish(std::move(next));
}

bool LiveFeed::is_map_due() const {
  const std::scoped_lock lock(mutex_);
  return LiveClock::now() - shown_ >= kMapInterval;
}

void LiveFeed::show(LiveMap now) {
  // Outside the lock, since it takes a while. Only the run's thread shows maps, so that none is lost.
  const auto map = std::make_shared<const LiveMap>(numbered(*latest()->map, std::move(now)));
  const std::scoped_lock lock(mutex_);
  shown_ = LiveClock::now();
  LiveSnapshot next = *latest_;
  next.map = map;
  publish(std::move(next));
}

void LiveFeed::end(const std::filesystem::path& report) { stop(LiveState::Ended, report, {}); }

void LiveFeed::fail(const std::string& why) { stop(LiveState::Failed, {}, why); }

void LiveFeed::stop(LiveState state, const std::filesystem::path& report, const std::string& why) {
  const std::scoped_lock lock(mutex_);
  LiveSnapshot next = *latest_;
  next.state = state;
  next.ended = LiveClock::now();
  next.report = report;
  next.why = why;
  publish(std::move(next));
}

std::shared_ptr<const LiveSnapshot> LiveFeed::latest() const {
  const std::scoped_lock lock(mutex_);
  return latest_;
}

void LiveFeed::publish(LiveSnapshot next) { latest_ = std::make_shared<const LiveSnapshot>(std::move(next)); }

}  // namespace fabloop::apps
