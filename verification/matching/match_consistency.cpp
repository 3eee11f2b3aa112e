// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/match_consistency.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fabloop {
namespace {

constexpr double kFullTurnDeg = 360.0;
constexpr double kOctaves = 16.0;  ///< Range of growth, half of it either way: beyond any detector's.

std::optional<double> turn_of(const Features& query, const Features& match, const Match& m) {
  const float from = query.keypoints[static_cast<std::size_t>(m.query)].angle;
  const float to = match.keypoints[static_cast<std::size_t>(m.match)].angle;
  if (from < 0 || to < 0) return std::nullopt;
  const double turn = std::fmod(static_cast<double>(to) - static_cast<double>(from) + kFullTurnDeg, kFullTurnDeg);
  return turn < kFullTurnDeg ? turn : 0.0;
}

std::optional<double> growth_of(const Features& query, const Features& match, const Match& m) {
  const float from = query.keypoints[static_cast<std::size_t>(m.query)].size;
  const float to = match.keypoints[static_cast<std::size_t>(m.match)].size;
  if (!(from > 0) || !(to > 0)) return std::nullopt;
  return std::clamp(std::log2(static_cast<double>(to) / static_cast<double>(from)), -0.5 * kOctaves, 0.5 * kOctaves);
}

/// Distance on a circle of the given length.
double circular_distance(double a, double b, double period) { return std::abs(std::remainder(a - b, period)); }

/// The mode of a circular histogram smoothed over the tolerance, moved to the mean of what it covers. None when chance, which
/// spreads values evenly, would put as many there.
template <std::size_t kBins>
std::optional<CommonValue> common_value(const std::vector<double>& values, double period, double tolerance,
                                        double min_significance) {
  if (values.empty()) return std::nullopt;
  std::array<double, kBins> counts{}, smoothed{};
  constexpr auto kCount = static_cast<double>(kBins);
  for (const double value : values) {
    const double place = std::fmod(value / period * kCount + kCount, kCount);
    counts[std::min(static_cast<std::size_t>(place), kBins - 1)] += 1;
  }
  // A triangle as wide as the tolerance: the middle of the matches counts most.
  const auto reach = static_cast<std::ptrdiff_t>(std::clamp(tolerance / period * kCount, 1.0, kCount / 2 - 1));
  for (std::ptrdiff_t bin = 0; bin < static_cast<std::ptrdiff_t>(kBins); ++bin) {
    for (std::ptrdiff_t offset = -reach; offset <= reach; ++offset) {
      const auto other =
          static_cast<std::size_t>((bin + offset + static_cast<std::ptrdiff_t>(kBins)) % static_cast<std::ptrdiff_t>(kBins));
      smoothed[static_cast<std::size_t>(bin)] += static_cast<double>(reach + 1 - std::abs(offset)) * counts[other];
    }
  }
  const auto best = std::max_element(smoothed.begin(), smoothed.end()) - smoothed.begin();
  const double mode = (static_cast<double>(best) + 0.5) * period / kCount;
  double sum = 0, num_near = 0;
  for (const double value : values) {
    if (circular_distance(value, mode, period) > 0.5 * tolerance) continue;
    sum += std::remainder(value - mode, period);
    num_near += 1;
  }
  const double middle = num_near > 0 ? mode + sum / num_near : mode;
  const auto count = static_cast<double>(values.size());
  const auto num_within = static_cast<double>(std::count_if(
      values.begin(), values.end(), [&](double value) { return circular_distance(value, middle, period) <= tolerance; }));
  const double p = std::min(2.0 * tolerance / period, 1.0);
  if (num_within - p * count < min_significance * std::sqrt(p * (1.0 - p) * count)) return std::nullopt;
  return CommonValue{middle, num_within / count};
}

}  // namespace

ViewChange view_change(const Features& query, const Features& match, const std::vector<Match>& matches,
                       const MatchConsistencyOptions& options) {
  std::vector<double> turns, growths;
  for (const Match& m : matches) {
    if (const auto turn = turn_of(query, match, m)) turns.push_back(*turn);
    if (const auto growth = growth_of(query, match, m)) growths.push_back(*growth);
  }
  ViewChange change;
  change.turn_deg = common_value<72>(turns, kFullTurnDeg, options.max_turn_difference_deg, options.min_significance);
  change.log2_growth = common_value<64>(growths, kOctaves, options.max_log2_growth_difference, options.min_significance);
  if (change.turn_deg) change.turn_deg->value = std::fmod(change.turn_deg->value + kFullTurnDeg, kFullTurnDeg);
  if (change.log2_growth) change.log2_growth->value = std::remainder(change.log2_growth->value, kOctaves);
  return change;
}

bool agrees_with(const ViewChange& change, const Features& query, const Features& match, const Match& candidate,
                 const MatchConsistencyOptions& options) {
  const auto turn = turn_of(query, match, candidate);
  if (change.turn_deg && turn && circular_distance(*turn, change.turn_deg->value, kFullTurnDeg) > options.max_turn_difference_deg)
    return false;
  const auto growth = growth_of(query, match, candidate);
  return !(change.log2_growth && growth && std::abs(*growth - change.log2_growth->value) > options.max_log2_growth_difference);
}

std::vector<Match> consistent_first(const Features& query, const Features& match, const std::vector<Match>& matches,
                                    const MatchConsistencyOptions& options) {
  const ViewChange change = view_change(query, match, matches, options);
  std::vector<Match> sorted = matches;
  std::stable_partition(sorted.begin(), sorted.end(),
                        [&](const Match& m) { return agrees_with(change, query, match, m, options); });
  return sorted;
}

std::vector<Match> consistent_only(const Features& query, const Features& match, const std::vector<Match>& matches,
                                   const MatchConsistencyOptions& options) {
  const ViewChange change = view_change(query, match, matches, options);
  std::vector<Match> kept = matches;
  std::erase_if(kept, [&](const Match& m) { return !agrees_with(change, query, match, m, options); });
  return kept;
}

}  // namespace fabloop
