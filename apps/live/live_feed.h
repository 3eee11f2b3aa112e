// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "apps/live/live_map.h"

namespace fabloop::apps {

using LiveClock = std::chrono::steady_clock;

enum class LiveState {
  Running,
  Ended,   ///< The run folder is complete.
  Failed,  ///< See LiveSnapshot::why.
};

/// How far a stage is.
struct LiveStage {
  std::string name;
  std::size_t done = 0, total = 0;  ///< `total` is 0 where nobody knows.
  double seconds_before = 0;        ///< Spent on it in earlier turns.
  LiveClock::time_point began;      ///< Of this turn; counts for the last stage only.
};

/// All that a page shows of a run at one moment. Never changes.
struct LiveSnapshot {
  std::string run;  ///< A name that no other run has, for pages that outlive the run that they are of.
  LiveState state = LiveState::Running;
  LiveClock::time_point began, ended;  ///< `ended` counts when it does not run.
  std::vector<LiveStage> stages;       ///< In the order of their first turns, but the present one last.
  std::shared_ptr<const LiveMap> map;  ///< Shared by the snapshots between which it did not change. Never null.
  std::filesystem::path report;        ///< Of a run that has ended; empty: none was asked for.
  std::string why;                     ///< It failed.
};

/// What a run tells and a server shows: the run publishes snapshots, and any thread may take the latest. Safe from all threads.
class LiveFeed {
 public:
  LiveFeed();

  /// As Progress: the stage that the run is in, and how much of it is done.
  void tell_progress(std::string_view stage, std::size_t done, std::size_t total);

  /// Whether it is time to show the map again. Asked before the map is put together, since a run would ask far more often than
  /// anybody looks.
  bool is_map_due() const;

  /// The map as it is now, without numbers.
  void show(LiveMap now);

  /// The run folder is complete, with a report or, empty, without.
  void end(const std::filesystem::path& report);
  void fail(const std::string& why);

  std::shared_ptr<const LiveSnapshot> latest() const;

 private:
  void stop(LiveState state, const std::filesystem::path& report, const std::string& why);
  void publish(LiveSnapshot next);

  mutable std::mutex mutex_;  ///< Of all below.
  std::shared_ptr<const LiveSnapshot> latest_;
  LiveClock::time_point told_, shown_;
};

}  // namespace fabloop::apps
