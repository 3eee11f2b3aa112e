// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace fabloop {

/// How long one stage of the work took.
struct StageTimes {
  std::size_t count = 0;
  double p50_ms = 0.0;  ///< Half of them took no longer (nearest rank).
  double p99_ms = 0.0;
  double max_ms = 0.0;
  double total_s = 0.0;
};

/// From the seconds that each piece of work took, in any order.
StageTimes stage_times(std::vector<double> seconds);

/// As it stands in summaries: `count`, `p50_ms`, `p99_ms`, `max_ms`, `total_s`.
std::string to_json(const StageTimes& times);

}  // namespace fabloop
