// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching.h"

#include <cblas.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <utility>

namespace fabloop {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Squared distances between all rows, Q x M, through |a - b|^2 = |a|^2 + |b|^2 - 2 a.b.
cv::Mat1f squared_euclidean(const cv::Mat& query, const cv::Mat& match) {
  cv::Mat1f distances(query.rows, match.rows);
  cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasTrans, query.rows, match.rows, query.cols, -2.0F, query.ptr<float>(), query.cols,
              match.ptr<float>(), match.cols, 0.0F, distances.ptr<float>(), match.rows);
  std::vector<float> match_norms(static_cast<std::size_t>(match.rows));
  for (int m = 0; m < match.rows; ++m) {
    match_norms[static_cast<std::size_t>(m)] = cblas_sdot(match.cols, match.ptr<float>(m), 1, match.ptr<float>(m), 1);
  }
  for (int q = 0; q < query.rows; ++q) {
    const float query_norm = cblas_sdot(query.cols, query.ptr<float>(q), 1, query.ptr<float>(q), 1);
    float* row = distances.ptr<float>(q);
    for (int m = 0; m < match.rows; ++m) row[m] = std::max(0.0F, row[m] + query_norm + match_norms[static_cast<std::size_t>(m)]);
  }
  return distances;
}

/// Squared Hamming distances between all rows, so that one ratio test serves both kinds.
cv::Mat1f squared_hamming(const cv::Mat& query, const cv::Mat& match) {
  cv::Mat counts;
  cv::batchDistance(query, match, counts, CV_32S, cv::noArray(), cv::NORM_HAMMING);
  cv::Mat1f distances;
  counts.convertTo(distances, CV_32F);
  cv::multiply(distances, distances, distances);
  return distances;
}

std::vector<int> nearest_rows(const cv::Mat1f& distances) {
  std::vector<float> best(static_cast<std::size_t>(distances.cols), kInfinity);
  std::vector<int> nearest(static_cast<std::size_t>(distances.cols), -1);
  for (int q = 0; q < distances.rows; ++q) {
    const float* row = distances.ptr<float>(q);
    for (int m = 0; m < distances.cols; ++m) {
      const auto k = static_cast<std::size_t>(m);
      if (row[m] < best[k]) {
        best[k] = row[m];
        nearest[k] = q;
      }
    }
  }
  return nearest;
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
    if (row[m] >= nearest.second_distance || static_cast<int>(m) == nearest.index) continue;
    if (!same_spot(keypoints[m], best_keypoint, same_spot_px)) nearest.second_distance = row[m];
  }
  return nearest;
}

/// Keeps the first match of each spot of the query.
std::vector<Match> one_a_spot(const std::vector<Match>& matches, const std::vector<cv::KeyPoint>& keypoints, double same_spot_px) {
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
  assert(query.kind == match.kind);
  if (query.keypoints.empty() || match.keypoints.empty()) return {};
  const bool has_bits = query.descriptors.type() == CV_8U;
  const cv::Mat1f distances =
      has_bits ? squared_hamming(query.descriptors, match.descriptors) : squared_euclidean(query.descriptors, match.descriptors);
  const std::vector<int> nearest_query = nearest_rows(distances);
  std::vector<Match> matches;
  for (int q = 0; q < distances.rows; ++q) {
    const Nearest nearest = nearest_of_row(distances.ptr<float>(q), match.keypoints, options.same_spot_px);
    if (nearest_query[static_cast<std::size_t>(nearest.index)] != q) continue;
    const float ratio = nearest.second_distance > 0 ? std::sqrt(nearest.distance / nearest.second_distance) : 1.0F;
    if (ratio <= options.max_ratio) matches.push_back({q, nearest.index, ratio});
  }
  std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) { return a.ratio < b.ratio; });
  return options.same_spot_px > 0 ? one_a_spot(matches, query.keypoints, options.same_spot_px) : matches;
}

}  // namespace fabloop
