// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "frontend/features/features.h"
#include "verification/matching/matching.h"

namespace fabloop {

/// Whether two features of an image lie so close that they show one spot: SIFT gives a spot one feature for each of its
/// orientations.
inline bool same_spot(const Features& of, std::size_t a, std::size_t b, double distance_px) {
  const cv::Point2f apart = of.keypoints[a].pt - of.keypoints[b].pt;
  const double distance = distance_px * of.pixel_size;
  return std::abs(apart.x) < distance && std::abs(apart.y) < distance;
}

/// Keeps the first match of each spot of the query, in their order.
std::vector<Match> one_a_spot(const std::vector<Match>& matches, const Features& query, double same_spot_px);

/// Sorted by ratio, in their order where it is equal; then one a spot of the query, unless same_spot_px is 0.
std::vector<Match> most_distinctive_first(std::vector<Match> matches, const Features& query, double same_spot_px);

}  // namespace fabloop
