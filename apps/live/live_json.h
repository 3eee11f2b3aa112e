// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "apps/live/live_feed.h"

namespace fabloop::apps {

/// So many positions and loops at most in one answer, which bounds it to some 100 kB however long the run is.
inline constexpr std::size_t kMaxLiveItems = 4000;

/// What a page that has seen all changes up to the number `since` needs to show a snapshot: state, stages and counts, and the
/// items that changed after it, those that changed first. `since` is the number to ask with next; `more` says that there is more
/// already.
///   `placed`, `odometry`: [frame, x, y, z, frame, ...]; `loops`: [row, query, match, verdict, inliers, row, ...], verdicts as in
///   live_verdicts(); `world` and `up` as in LiveMap.
nlohmann::ordered_json live_json(const LiveSnapshot& snapshot, std::uint64_t since, LiveClock::time_point now,
                                 std::size_t max_items = kMaxLiveItems);

/// The names that the verdicts' numbers stand for.
nlohmann::ordered_json live_verdicts();

}  // namespace fabloop::apps
