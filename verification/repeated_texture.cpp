// SPDX-License-Identifier: BSD-3-Clause
#include "verification/repeated_texture.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

#include "verification/matching/feature_distances.h"
#include "verification/matching/spots.h"

namespace fabloop {
namespace {

std::size_t matched(const Match& m) { return static_cast<std::size_t>(m.match); }

/// Sorted by x, so that who shares a spot is near.
double share_of_shared_spots(const Features& match, std::vector<Match> matches, double same_spot_px) {
  const auto x_of = [&](const Match& m) { return match.keypoints[matched(m)].pt.x; };
  std::sort(matches.begin(), matches.end(), [&](const Match& a, const Match& b) { return x_of(a) < x_of(b); });
  std::vector<char> is_shared(matches.size(), 0);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    for (std::size_t j = i + 1; j < matches.size(); ++j) {
      if (!(x_of(matches[j]) - x_of(matches[i]) < same_spot_px * match.pixel_size)) break;
      if (same_spot(match, matched(matches[i]), matched(matches[j]), same_spot_px)) is_shared[i] = is_shared[j] = 1;
    }
  }
  return static_cast<double>(std::count(is_shared.begin(), is_shared.end(), char{1})) / static_cast<double>(matches.size());
}

std::vector<Match> evenly_chosen(const std::vector<Match>& matches, std::size_t most) {
  std::vector<Match> chosen;
  const std::size_t count = std::min(matches.size(), most);
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(matches[i * matches.size() / count]);
  return chosen;
}

/// For each of some rows of descriptors, the distances to all of the match's features: as many rows as `matches`.
cv::Mat1f distances_from(const Features& from, const std::vector<Match>& matches, int Match::*index, const FeatureDistances& to) {
  cv::Mat rows;
  for (const Match& m : matches) rows.push_back(from.descriptors.row(m.*index));
  cv::Mat1f distances(rows.rows, static_cast<int>(to.stride()));
  to(rows, distances.ptr<float>());
  return distances;
}

/// Number of features at other spots than `spot` whose distance is less than the limit.
std::size_t count_nearer(const float* distances, const Features& match, std::size_t spot, float limit, double same_spot_px) {
  std::size_t count = 0;
  for (std::size_t m = 0; m < match.keypoints.size(); ++m) {
    if (distances[m] < limit && !same_spot(match, m, spot, same_spot_px)) ++count;
  }
  return count;
}

}  // namespace

RepeatedTexture repeated_texture(const View& query, const View& match, const std::vector<Match>& matches,
                                 const RepeatedTextureOptions& options) {
  assert(options.near_ratio > 0 && options.max_matches > 0);
  if (matches.empty()) return {};
  const std::vector<Match> chosen = evenly_chosen(matches, static_cast<std::size_t>(options.max_matches));
  const FeatureDistances to_match(match.features.descriptors);
  const cv::Mat1f from_query = distances_from(query.features, chosen, &Match::query, to_match);
  const cv::Mat1f from_itself = distances_from(match.features, chosen, &Match::match, to_match);
  const bool is_squared = match.features.descriptors.type() == CV_32F;
  const auto near_factor = static_cast<float>(1.0 / (is_squared ? options.near_ratio * options.near_ratio : options.near_ratio));
  std::size_t num_rivals = 0, num_with_lookalike = 0;
  for (int i = 0; i < from_query.rows; ++i) {
    const Match& m = chosen[static_cast<std::size_t>(i)];
    const float distance = from_query(i, m.match);
    const auto count = [&](const cv::Mat1f& distances, float limit) {
      return count_nearer(distances[i], match.features, matched(m), limit, options.same_spot_px);
    };
    num_rivals += count(from_query, near_factor * distance);
    if (count(from_itself, distance) > 0) ++num_with_lookalike;
  }
  const auto num_chosen = static_cast<double>(chosen.size());
  return {share_of_shared_spots(match.features, matches, options.same_spot_px), static_cast<double>(num_rivals) / num_chosen,
          static_cast<double>(num_with_lookalike) / num_chosen};
}

}  // namespace fabloop
