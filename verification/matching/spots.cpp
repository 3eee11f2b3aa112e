// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/spots.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace fabloop {

std::vector<Match> one_a_spot(const std::vector<Match>& matches, const Features& query, double same_spot_px) {
  const auto feature_of = [&](std::size_t i) { return static_cast<std::size_t>(matches[i].query); };
  const auto x_of = [&](std::size_t i) { return query.keypoints[feature_of(i)].pt.x; };
  const double reach = same_spot_px * query.pixel_size;
  std::vector<std::size_t> by_x(matches.size()), place(matches.size());
  std::iota(by_x.begin(), by_x.end(), std::size_t{0});
  std::sort(by_x.begin(), by_x.end(), [&](std::size_t a, std::size_t b) { return x_of(a) < x_of(b); });
  for (std::size_t i = 0; i < by_x.size(); ++i) place[by_x[i]] = i;

  std::vector<char> is_taken(matches.size(), 0);
  std::vector<Match> kept;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (is_taken[i] != 0) continue;
    kept.push_back(matches[i]);
    // False where the neighbours end: they are sorted by x.
    const auto take = [&](std::size_t other) {
      if (same_spot(query, feature_of(i), feature_of(other), same_spot_px)) is_taken[other] = 1;
      return std::abs(x_of(i) - x_of(other)) < reach;
    };
    for (std::size_t j = place[i]; j > 0 && take(by_x[j - 1]);) --j;
    for (std::size_t j = place[i] + 1; j < by_x.size() && take(by_x[j]);) ++j;
  }
  return kept;
}

std::vector<Match> most_distinctive_first(std::vector<Match> matches, const Features& query, double same_spot_px) {
  std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) { return a.ratio < b.ratio; });
  return same_spot_px > 0 ? one_a_spot(matches, query, same_spot_px) : matches;
}

}  // namespace fabloop
