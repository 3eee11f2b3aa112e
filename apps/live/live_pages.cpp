// SPDX-License-Identifier: BSD-3-Clause
#include "apps/live/live_pages.h"

#include <algorithm>
#include <chrono>

namespace fabloop::apps {
namespace {

/// Pages ask once a second; those that have not for so long are closed, or asleep in the background.
constexpr auto kLately = std::chrono::milliseconds(2500);
/// Whoever asks under ever new names fills no memory.
constexpr std::size_t kMaxPages = 64, kMaxName = 64;

}  // namespace

void LivePages::answered(const std::string& page, LiveState state, bool wants_report, LiveClock::time_point now) {
  if (page.empty() || page.size() > kMaxName) return;
  const std::scoped_lock lock(mutex_);
  if (pages_.size() >= kMaxPages) std::erase_if(pages_, [&](const auto& known) { return now - known.second.asked >= kLately; });
  if (pages_.size() >= kMaxPages && !pages_.contains(page)) return;
  Page& known = pages_[page];
  known.asked = now;
  known.has_all = known.has_all || (state != LiveState::Running && !wants_report);
}

void LivePages::got_report(const std::string& page) {
  const std::scoped_lock lock(mutex_);
  const auto known = pages_.find(page);
  if (known != pages_.end()) known->second.has_all = true;
}

bool LivePages::is_any_waiting(LiveClock::time_point now) const {
  const std::scoped_lock lock(mutex_);
  return std::any_of(pages_.begin(), pages_.end(),
                     [&](const auto& page) { return !page.second.has_all && now - page.second.asked < kLately; });
}

}  // namespace fabloop::apps
