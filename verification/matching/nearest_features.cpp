// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/nearest_features.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "frontend/features/row_minima.h"
#include "verification/matching/feature_distances.h"
#include "verification/matching/spots.h"

namespace fabloop {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// The least distance to another spot than the nearest feature's. Changes the row.
float second_best(float* row, std::size_t stride, std::size_t nearest, const Features& match, double same_spot_px) {
  // Mostly the next nearest shows another spot already. Where many show the same, one look at each ends it.
  constexpr int kTries = 4;
  row[nearest] = kInfinity;
  for (int i = 0; i < kTries; ++i) {
    const float least = least_of(row, stride);
    if (least == kInfinity) return least;
    const std::size_t index = first_equal(row, stride, least);
    if (!same_spot(match, index, nearest, same_spot_px)) return least;
    row[index] = kInfinity;
  }
  for (std::size_t m = 0; m < match.keypoints.size(); ++m) {
    if (same_spot(match, m, nearest, same_spot_px)) row[m] = kInfinity;
  }
  return least_of(row, stride);
}

}  // namespace

std::vector<NearestFeature> mutually_nearest(const Features& query, const Features& match, double same_spot_px) {
  constexpr int kRowsAtOnce = 60;
  const FeatureDistances distances_of(match.descriptors);
  const std::size_t stride = distances_of.stride();
  std::vector<float> distances(static_cast<std::size_t>(std::min(kRowsAtOnce, query.descriptors.rows)) * stride);
  std::vector<float> to_nearest_query(stride, kInfinity);
  std::vector<NearestFeature> nearest(query.keypoints.size());
  for (int begin = 0; begin < query.descriptors.rows; begin += kRowsAtOnce) {
    const int end = std::min(begin + kRowsAtOnce, query.descriptors.rows);
    distances_of(query.descriptors.rowRange(begin, end), distances.data());
    for (int q = begin; q < end; ++q) {
      float* row = distances.data() + static_cast<std::size_t>(q - begin) * stride;
      NearestFeature& found = nearest[static_cast<std::size_t>(q)];
      found.distance = least_of_and_lower(row, stride, to_nearest_query.data());
      const std::size_t index = first_equal(row, stride, found.distance);
      if (found.distance > to_nearest_query[index]) continue;  // an earlier query has it
      found.index = static_cast<int>(index);
      found.second_distance = second_best(row, stride, index, match, same_spot_px);
    }
  }
  nearest = only_mutual(std::move(nearest), std::move(to_nearest_query));
  if (query.descriptors.type() == CV_32F) return nearest;
  for (NearestFeature& found : nearest) {
    found.distance *= found.distance;
    found.second_distance *= found.second_distance;
  }
  return nearest;
}

NearestFeature nearest_of(std::span<const int> candidates, std::span<const float> distances, const Features& match,
                          double same_spot_px) {
  NearestFeature nearest;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const bool is_first = distances[i] == nearest.distance && candidates[i] < nearest.index;
    if (distances[i] < nearest.distance || is_first) {
      nearest.index = candidates[i];
      nearest.distance = distances[i];
    }
  }
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i] == nearest.index || distances[i] >= nearest.second_distance) continue;
    const bool is_rival =
        !same_spot(match, static_cast<std::size_t>(candidates[i]), static_cast<std::size_t>(nearest.index), same_spot_px);
    if (is_rival) nearest.second_distance = distances[i];
  }
  return nearest;
}

std::vector<NearestFeature> only_mutual(std::vector<NearestFeature> nearest, std::vector<float> to_nearest_query) {
  for (NearestFeature& found : nearest) {
    if (found.index < 0) continue;
    float& least = to_nearest_query[static_cast<std::size_t>(found.index)];
    if (found.distance > least) {
      found.index = -1;
    } else {
      least = -1;
    }
  }
  return nearest;
}

float distance_ratio(float distance, float second_distance) {
  return second_distance > 0 ? std::sqrt(distance / second_distance) : 1.0F;
}

}  // namespace fabloop
