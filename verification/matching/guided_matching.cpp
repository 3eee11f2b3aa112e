// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/guided_matching.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "verification/matching/epipolar_pencil.h"
#include "verification/matching/feature_distances.h"
#include "verification/matching/nearest_features.h"
#include "verification/matching/spots.h"

namespace fabloop {
namespace {

constexpr float kFarAway = std::numeric_limits<float>::infinity();

/// For each feature of the query the nearest in its band, with index -1 where another query feature is nearer to that.
std::vector<NearestFeature> mutually_nearest_in_bands(const View& query, const View& match, const Pose& match_from_query,
                                                      const GuidedMatchingOptions& options) {
  const EpipolarPencil pencil(match.rays, match_from_query, options.max_error_rad);
  std::vector<NearestFeature> nearest(query.rays.size());
  std::vector<float> to_nearest_query(match.rays.size(), kFarAway);
  std::vector<int> candidates;
  std::vector<float> distances;
  for (std::size_t q = 0; q < nearest.size(); ++q) {
    candidates.clear();
    distances.clear();
    pencil.candidates(query.rays[q], candidates);
    if (options.change) {
      std::erase_if(candidates, [&](int m) {
        return !agrees_with(*options.change, query.features, match.features, {static_cast<int>(q), m}, options.consistency);
      });
    }
    for (const int m : candidates) {
      distances.push_back(squared_distance_between(query.features, static_cast<int>(q), match.features, m));
      float& least = to_nearest_query[static_cast<std::size_t>(m)];
      least = std::min(least, distances.back());
    }
    nearest[q] = nearest_of(candidates, distances, match.features, options.same_spot_px);
  }
  return only_mutual(std::move(nearest), std::move(to_nearest_query));
}

}  // namespace

std::vector<Match> guided_matches(const View& query, const View& match, const Pose& match_from_query,
                                  const GuidedMatchingOptions& options) {
  assert(query.features.descriptor_kind == match.features.descriptor_kind);
  if (query.rays.empty() || match.rays.empty()) return {};
  const float typical = typical_squared_distance(query.features, match.features);
  const auto nearest = mutually_nearest_in_bands(query, match, match_from_query, options);
  const double max_squared_distance =
      options.max_relative_distance * options.max_relative_distance * static_cast<double>(typical);
  std::vector<Match> matches;
  for (std::size_t q = 0; q < nearest.size(); ++q) {
    const NearestFeature& found = nearest[q];
    if (found.index < 0 || found.distance > max_squared_distance) continue;
    const float ratio = distance_ratio(found.distance, std::min(found.second_distance, typical));
    if (ratio <= options.max_ratio) matches.push_back({static_cast<int>(q), found.index, ratio, RatioAmong::Band});
  }
  return most_distinctive_first(std::move(matches), query.features, options.same_spot_px);
}

}  // namespace fabloop
