// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "verification/matching/matching.h"

namespace fabloop {

/// Whether two features lie so close that they show one spot: SIFT gives a spot one feature for each of its orientations.
inline bool same_spot(const cv::KeyPoint& a, const cv::KeyPoint& b, double distance_px) {
  return std::abs(a.pt.x - b.pt.x) < distance_px && std::abs(a.pt.y - b.pt.y) < distance_px;
}

/// Keeps the first match of each spot of the query, in their order. `keypoints` are the query's.
std::vector<Match> one_a_spot(const std::vector<Match>& matches, const std::vector<cv::KeyPoint>& keypoints, double same_spot_px);

/// Sorted by ratio, in their order where it is equal; then one a spot of the query, unless same_spot_px is 0.
std::vector<Match> most_distinctive_first(std::vector<Match> matches, const std::vector<cv::KeyPoint>& keypoints,
                                          double same_spot_px);

}  // namespace fabloop
