// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <utility>

#include "frontend/features/descriptor_distances.h"

namespace fabloop {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Squared Hamming distances between all rows, so that one ratio test serves both kinds.
cv::Mat1f squared_hamming(const cv::Mat& query, const cv::Mat& match) {
  cv::Mat counts;
  cv::batchDistance(query, match, counts, CV_32S, cv::noArray(), cv::NORM_HAMMING);
  cv::Mat1f distances;
  counts.convertTo(distances, CV_32F);
  cv::multiply(distances, distances, distances);
  return distances;
}

/// Smallest entry of each column.
std::vector<float> column_minima(const cv::Mat1f& distances) {
  std::vector<float> minima(static_cast<std::size_t>(distances.cols), kInfinity);
  for (int q = 0; q < distances.rows; ++q) {
    const float* row = distances.ptr<float>(q);
    for (std::size_t m = 0; m < minima.size(); ++m) minima[m] = row[m] < minima[m] ? row[m] : minima[m];
  }
  return minima;
}

bool same_spot(const cv::KeyPoint& a, const cv::KeyPoint& b, double distance_px) {
  return std::abs(a.pt.x - b.pt.x) < distance_px && std::abs(a.pt.y - b.pt.y) < distance_px;
}

struct Nearest {
  int index = -1;
  float distance = kInfinity;         ///< Squared.
  float second_distance = kInfinity;  ///< Squared, among features of other spots.
};

Nearest nearest_of_row(const float* row, const std::vector<cv::KeyPoint>& keypoints, double same_spot_px) {
  const auto* const end = row + keypoints.size();
  const auto* const best = std::min_element(row, end);
  Nearest nearest{static_cast<int>(best - row), *best, kInfinity};
  const auto& best_keypoint = keypoints[static_cast<std::size_t>(nearest.index)];
  for (std::size_t m = 0; m < keypoints.size(); ++m) {
    if (row[m] >= nearest.second_distance) continue;
    if (static_cast<int>(m) != nearest.index && !same_spot(keypoints[m], best_keypoint, same_spot_px))
      nearest.second_distance = row[m];
  }
  return nearest;
}

/// Keeps the first match of each spot of the query.
std::vector<Match> one_a_spot(const std::vector<Match>& matches, const std::vector<cv::KeyPoint>& keypoints,
                              double same_spot_px) {
  std::vector<Match> kept;
  for (const Match& match : matches) {
    const auto& keypoint = keypoints[static_cast<std::size_t>(match.query)];
    const bool taken = std::any_of(kept.begin(), kept.end(), [&](const Match& other) {
      return same_spot(keypoint, keypoints[static_cast<std::size_t>(other.query)], same_spot_px);
    });
    if (!taken) kept.push_back(match);
  }
  return kept;
}

}  // namespace

std::vector<Match> match_features(const Features& query, const Features& match, const MatchingOptions& options) {
  assert(query.descriptor_kind == match.descriptor_kind);
  if (query.keypoints.empty() || match.keypoints.empty()) return {};
  const bool has_bits = query.descriptors.type() == CV_8U;
  const cv::Mat1f distances = has_bits ? squared_hamming(query.descriptors, match.descriptors)
                                       : PackedDescriptors(match.descriptors).squared_distances(query.descriptors);
  std::vector<float> to_nearest_query = column_minima(distances);
  std::vector<Match> matches;
  for (int q = 0; q < distances.rows; ++q) {
    const Nearest nearest = nearest_of_row(distances.ptr<float>(q), match.keypoints, options.same_spot_px);
    float& least = to_nearest_query[static_cast<std::size_t>(nearest.index)];
    if (nearest.distance > least) continue;
    least = -1;  // of several queries at the same distance the first has it
    const float ratio = nearest.second_distance > 0 ? std::sqrt(nearest.distance / nearest.second_distance) : 1.0F;
    if (ratio <= options.max_ratio) matches.push_back({q, nearest.index, ratio});
  }
  std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) { return a.ratio < b.ratio; });
  return options.same_spot_px > 0 ? one_a_spot(matches, query.keypoints, options.same_spot_px) : matches;
}

}  // namespace fabloop
