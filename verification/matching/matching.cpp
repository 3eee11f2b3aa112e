// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/matching.h"

#include <cassert>
#include <utility>

#include "verification/matching/nearest_features.h"
#include "verification/matching/spots.h"

namespace fabloop {

std::vector<Match> match_features(const Features& query, const Features& match, const MatchingOptions& options) {
  assert(query.descriptor_kind == match.descriptor_kind);
  if (query.keypoints.empty() || match.keypoints.empty()) return {};
  const bool is_exact = options.search == MatchSearch::Exact || query.descriptors.type() != CV_32F;
  const std::vector<NearestFeature> nearest =
      is_exact ? mutually_nearest(query, match, options.same_spot_px) : approximately_mutually_nearest(query, match, options);
  std::vector<Match> matches;
  for (std::size_t q = 0; q < nearest.size(); ++q) {
    const NearestFeature& found = nearest[q];
    if (found.index < 0) continue;
    const float ratio = distance_ratio(found.distance, found.second_distance);
    if (ratio <= options.max_ratio) matches.push_back({static_cast<int>(q), found.index, ratio});
  }
  return most_distinctive_first(std::move(matches), query, options.same_spot_px);
}

}  // namespace fabloop
