// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/spots.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace fabloop {

std::vector<Match> one_a_spot(const std::vector<Match>& matches, const std::vector<cv::KeyPoint>& keypoints,
                              double same_spot_px) {
  const auto keypoint_of = [&](std::size_t i) -> const cv::KeyPoint& {
    return keypoints[static_cast<std::size_t>(matches[i].query)];
  };
  std::vector<std::size_t> by_x(matches.size()), place(matches.size());
  std::iota(by_x.begin(), by_x.end(), std::size_t{0});
  std::sort(by_x.begin(), by_x.end(), [&](std::size_t a, std::size_t b) { return keypoint_of(a).pt.x < keypoint_of(b).pt.x; });
  for (std::size_t i = 0; i < by_x.size(); ++i) place[by_x[i]] = i;

  std::vector<char> is_taken(matches.size(), 0);
  std::vector<Match> kept;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (is_taken[i] != 0) continue;
    kept.push_back(matches[i]);
    const cv::KeyPoint& keypoint = keypoint_of(i);
    // False where the neighbours end: they are sorted by x.
    const auto take = [&](std::size_t other) {
      if (same_spot(keypoint, keypoint_of(other), same_spot_px)) is_taken[other] = 1;
      return std::abs(keypoint.pt.x - keypoint_of(other).pt.x) < same_spot_px;
    };
    for (std::size_t j = place[i]; j > 0 && take(by_x[j - 1]);) --j;
    for (std::size_t j = place[i] + 1; j < by_x.size() && take(by_x[j]);) ++j;
  }
  return kept;
}

std::vector<Match> most_distinctive_first(std::vector<Match> matches, const std::vector<cv::KeyPoint>& keypoints,
                                          double same_spot_px) {
  std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) { return a.ratio < b.ratio; });
  return same_spot_px > 0 ? one_a_spot(matches, keypoints, same_spot_px) : matches;
}

}  // namespace fabloop
