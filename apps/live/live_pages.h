// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "apps/live/live_feed.h"

namespace fabloop::apps {

/// Which pages are open, by the names that they give themselves, and which of them know how the run ended. Safe from all threads.
class LivePages {
 public:
  /// A page has got an answer of this state, and will ask for the report when it `wants_report`.
  void answered(const std::string& page, LiveState state, bool wants_report, LiveClock::time_point now);
  /// A page has got the report.
  void got_report(const std::string& page);
  /// Whether a page that asked lately does not yet have all that it will ask for.
  bool is_any_waiting(LiveClock::time_point now) const;

 private:
  struct Page {
    LiveClock::time_point asked;
    bool has_all = false;
  };
  mutable std::mutex mutex_;  ///< Of the pages.
  std::map<std::string, Page> pages_;
};

}  // namespace fabloop::apps
