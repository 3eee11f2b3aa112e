// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "verification/matching/matching.h"
#include "verification/pose/relative_pose.h"
#include "verification/view.h"

namespace fabloop {

/// The rays of the matches of two views, in their order.
inline std::vector<RayPair> ray_pairs(const View& query, const View& match, const std::vector<Match>& matches) {
  std::vector<RayPair> pairs;
  pairs.reserve(matches.size());
  for (const Match& m : matches) {
    pairs.push_back({query.rays[static_cast<std::size_t>(m.query)], match.rays[static_cast<std::size_t>(m.match)]});
  }
  return pairs;
}

}  // namespace fabloop
