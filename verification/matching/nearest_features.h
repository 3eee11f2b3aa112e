// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "frontend/features/features.h"
#include "verification/matching/matching.h"

namespace fabloop {

/// What of the match looks most like one feature of the query.
struct NearestFeature {
  int index = -1;
  float distance = std::numeric_limits<float>::infinity();         ///< Squared, of floats and bits alike.
  float second_distance = std::numeric_limits<float>::infinity();  ///< Squared, among features of other spots than the nearest.
};

/// For each feature of the query the nearest of the match (the first of several equally near) with index -1 where another
/// query feature is nearer to it (of several equally near, the first has it). Exact, and exhaustive; only a few rows of the
/// table of all distances exist at a time. Neither side is empty.
std::vector<NearestFeature> mutually_nearest(const Features& query, const Features& match, double same_spot_px);

/// The same of floats, by a search that may miss the nearest or the second. Only what passes the ratio test is held against
/// the other direction.
std::vector<NearestFeature> approximately_mutually_nearest(const Features& query, const Features& match,
                                                           const MatchingOptions& options);

/// The nearest of some features of the match (the lower of several equally near), by their squared distances, and the second
/// at another spot. Index -1 for no candidates.
NearestFeature nearest_of(std::span<const int> candidates, std::span<const float> distances, const Features& match,
                          double same_spot_px);

/// Takes the index of those whose nearest feature has a nearer query; of several equally near, the first keeps it.
/// `to_nearest_query`: the least distance to each feature of the match.
std::vector<NearestFeature> only_mutual(std::vector<NearestFeature> nearest, std::vector<float> to_nearest_query);

/// From squared distances; 1 when the second is 0.
float distance_ratio(float distance, float second_distance);

}  // namespace fabloop
