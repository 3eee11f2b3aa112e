// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "apps/command.h"
#include "apps/live/live_feed.h"
#include "apps/live/live_server.h"
#include "frontend/progress.h"
#include "posegraph/map_sequence.h"
#include "posegraph/sfm/reconstruct.h"

namespace fabloop::apps {

/// What `--live [PORT]` said.
struct LiveArguments {
  bool is_asked = false;
  int port = 0;  ///< 0: any that is free.
};

void add_live_argument(CLI::App* command, LiveArguments& arguments);

/// What the page has to show.
enum class LiveShows {
  Map,       ///< A map that grows, which its report takes the place of.
  Progress,  ///< Stages and how far they are, of a run without a map.
};

/// A run that a page shows while it goes on, or, where that was not asked for, one that costs nothing: then nothing is served,
/// and callbacks are those that were given, or none.
class LiveRun {
 public:
  /// Serves from here on and prints where. `out` is the run's folder. Throws InputError when the port cannot be had.
  LiveRun(const LiveArguments& arguments, const std::string& title, const std::filesystem::path& out,
          LiveShows shows = LiveShows::Map);

  /// Tells the page, too.
  Progress progress(Progress also) const;
  WatchMap watch_map() const;
  WatchPlaced watch_placed() const;
  /// A stage that has no progress of its own begins.
  void begin_stage(const char* stage) const;

  /// Does the run's work, and lets the pages that are open know how it ended: its report (empty: none), or what was thrown.
  void until_end_of(const std::function<std::filesystem::path()>& work);

 private:
  std::shared_ptr<LiveFeed> feed_;  ///< Shared with the callbacks, which may outlive this. Null: nothing is served.
  std::unique_ptr<LiveServer> server_;
};

}  // namespace fabloop::apps
