// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/stage_times.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

namespace fabloop {
namespace {

/// The value below which a share of the sorted values lies (nearest rank).
double percentile(const std::vector<double>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::min(sorted.size() - 1, rank == 0 ? 0 : rank - 1)];
}

}  // namespace

StageTimes stage_times(std::vector<double> seconds) {
  if (seconds.empty()) return {};
  std::sort(seconds.begin(), seconds.end());
  return {seconds.size(), 1e3 * percentile(seconds, 0.50), 1e3 * percentile(seconds, 0.99), 1e3 * seconds.back(),
          std::accumulate(seconds.begin(), seconds.end(), 0.0)};
}

std::string to_json(const StageTimes& times) {
  return nlohmann::ordered_json{{"count", times.count},
                                {"p50_ms", times.p50_ms},
                                {"p99_ms", times.p99_ms},
                                {"max_ms", times.max_ms},
                                {"total_s", times.total_s}}
      .dump();
}

}  // namespace fabloop
