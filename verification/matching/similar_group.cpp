// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/similar_group.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

namespace fabloop {
namespace {

using Complex = std::complex<double>;

/// A match as a similarity sees it.
struct Placed {
  Complex query, match;
  std::optional<double> turn_rad;
  double log2_growth = 0;
};

Complex place_of(const cv::KeyPoint& keypoint) { return {keypoint.pt.x, keypoint.pt.y}; }

std::vector<Placed> placed_matches(const Features& query, const Features& match, const std::vector<Match>& matches,
                                   std::size_t count) {
  std::vector<Placed> placed;
  for (std::size_t i = 0; i < std::min(count, matches.size()); ++i) {
    const cv::KeyPoint& from = query.keypoints[static_cast<std::size_t>(matches[i].query)];
    const cv::KeyPoint& to = match.keypoints[static_cast<std::size_t>(matches[i].match)];
    Placed here{place_of(from), place_of(to), {}, 0};
    if (from.angle >= 0 && to.angle >= 0) here.turn_rad = (to.angle - from.angle) * std::numbers::pi / 180.0;
    if (from.size > 0 && to.size > 0) here.log2_growth = std::log2(to.size / from.size);
    placed.push_back(here);
  }
  return placed;
}

/// The larger side of the box around the keypoints.
double extent_of(const std::vector<cv::KeyPoint>& keypoints) {
  cv::Point2f low = keypoints.front().pt, high = low;
  for (const cv::KeyPoint& keypoint : keypoints) {
    low = {std::min(low.x, keypoint.pt.x), std::min(low.y, keypoint.pt.y)};
    high = {std::max(high.x, keypoint.pt.x), std::max(high.y, keypoint.pt.y)};
  }
  return std::max(high.x - low.x, high.y - low.y);
}

/// Which matches follow a similarity: limits in the units of Placed.
struct Limits {
  double offset_px;
  double turn_rad;
  double log2_growth;

  bool allow(const Placed& candidate, double turn_rad_of_all, double log2_growth_of_all) const {
    if (std::abs(candidate.log2_growth - log2_growth_of_all) > log2_growth) return false;
    if (!candidate.turn_rad) return true;
    return std::abs(std::remainder(*candidate.turn_rad - turn_rad_of_all, 2 * std::numbers::pi)) <= turn_rad;
  }
};

}  // namespace

std::size_t largest_similar_group(const Features& query, const Features& match, const std::vector<Match>& matches,
                                  const SimilarGroupOptions& options) {
  if (matches.size() < 2) return matches.size();
  const std::vector<Placed> placed = placed_matches(query, match, matches, options.max_matches);
  const Limits limits{options.max_offset * extent_of(match.keypoints), options.max_turn_difference_deg * std::numbers::pi / 180.0,
                      options.max_log2_growth_difference};
  std::size_t largest = 1;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    for (std::size_t j = i + 1; j < placed.size(); ++j) {
      const Complex query_step = placed[j].query - placed[i].query;
      const Complex match_step = placed[j].match - placed[i].match;
      // Closer together they tell neither turn nor growth.
      if (std::min(std::abs(query_step), std::abs(match_step)) < limits.offset_px) continue;
      const Complex similarity = match_step / query_step;
      const double turn_rad = std::arg(similarity), log2_growth = std::log2(std::abs(similarity));
      if (!limits.allow(placed[i], turn_rad, log2_growth) || !limits.allow(placed[j], turn_rad, log2_growth)) continue;
      const auto follows = [&](const Placed& other) {
        return limits.allow(other, turn_rad, log2_growth) &&
               std::abs(placed[i].match + similarity * (other.query - placed[i].query) - other.match) <= limits.offset_px;
      };
      largest = std::max(largest, static_cast<std::size_t>(std::count_if(placed.begin(), placed.end(), follows)));
      if (largest >= options.enough) return largest;
    }
  }
  return largest;
}

}  // namespace fabloop
