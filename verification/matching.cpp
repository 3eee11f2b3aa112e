// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "verification/nearest_features.h"
#include "verification/spots.h"

namespace fabloop {

std::vector<Match> match_features(const Features& query, const Features& match, const MatchingOptions& options) {
  assert(query.descriptor_kind == match.descriptor_kind);
  if (query.keypoints.empty() || match.keypoints.empty()) return {};
  const std::vector<NearestFeature> nearest = mutually_nearest(query, match, options.same_spot_px);
  std::vector<Match> matches;
  for (std::size_t q = 0; q < nearest.size(); ++q) {
    const NearestFeature& found = nearest[q];
    if (found.index < 0) continue;
    const float ratio = found.second_distance > 0 ? std::sqrt(found.distance / found.second_distance) : 1.0F;
    if (ratio <= options.max_ratio) matches.push_back({static_cast<int>(q), found.index, ratio});
  }
  std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) { return a.ratio < b.ratio; });
  return options.same_spot_px > 0 ? one_a_spot(matches, query.keypoints, options.same_spot_px) : matches;
}

}  // namespace fabloop
