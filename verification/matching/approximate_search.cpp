// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "frontend/fabmap/row_search.h"
#include "verification/matching/feature_distances.h"
#include "verification/matching/nearest_features.h"
#include "verification/matching/spots.h"

namespace fabloop {
namespace {

/// Matching is one of many things that run at a time; the caller divides the work.
constexpr int kNumThreads = 1;

/// The rows of those features.
cv::Mat rows_of(const cv::Mat& descriptors, const std::vector<int>& features) {
  cv::Mat rows;
  for (const int feature : features) rows.push_back(descriptors.row(feature));
  return rows;
}

/// Looks again, exhaustively, for the second best where what was found shows the nearest one's spot.
void replace_same_spots(const Features& query, const Features& match, const NearestRows& found, double same_spot_px,
                        std::vector<NearestFeature>& nearest) {
  std::vector<int> all(match.keypoints.size());
  for (std::size_t m = 0; m < all.size(); ++m) all[m] = static_cast<int>(m);
  std::vector<float> distances(all.size());
  for (std::size_t q = 0; q < nearest.size(); ++q) {
    if (nearest[q].second_distance == std::numeric_limits<float>::infinity() ||
        !same_spot(match, found.second_row[q], found.row[q], same_spot_px))
      continue;
    for (const int m : all) {
      distances[static_cast<std::size_t>(m)] = squared_distance_between(query, static_cast<int>(q), match, m);
    }
    nearest[q] = nearest_of(all, distances, match, same_spot_px);
  }
}

}  // namespace

std::vector<NearestFeature> approximately_mutually_nearest(const Features& query, const Features& match,
                                                           const MatchingOptions& options) {
  const NearestRows found = RowSearch(match.descriptors, RowSearchKind::ManyTimes).near_two(query.descriptors, kNumThreads);
  std::vector<NearestFeature> nearest(query.keypoints.size());
  for (std::size_t q = 0; q < nearest.size(); ++q) {
    nearest[q] = {static_cast<int>(found.row[q]), found.squared_distance[q], found.second_squared_distance[q]};
  }
  if (options.same_spot_px > 0) replace_same_spots(query, match, found, options.same_spot_px, nearest);
  std::vector<int> queries, matches;
  std::vector<std::uint32_t> guesses;
  for (std::size_t q = 0; q < nearest.size(); ++q) {
    if (distance_ratio(nearest[q].distance, nearest[q].second_distance) > options.max_ratio) {
      nearest[q].index = -1;
      continue;
    }
    queries.push_back(static_cast<int>(q));
    matches.push_back(nearest[q].index);
    guesses.push_back(static_cast<std::uint32_t>(q));
  }
  if (queries.empty()) return nearest;
  const NearestRows back =
      RowSearch(query.descriptors, RowSearchKind::ManyTimes).near(rows_of(match.descriptors, matches), kNumThreads, guesses);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (back.row[i] != static_cast<std::uint32_t>(queries[i])) nearest[static_cast<std::size_t>(queries[i])].index = -1;
  }
  return nearest;
}

}  // namespace fabloop
