// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/adaptive_detection.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>

#include "frontend/features/detectors.h"

namespace fabloop {
namespace {

/// What a response is multiplied with to compare with the threshold; none where they are about different things.
std::optional<double> threshold_per_response(const FeatureOptions& options) {
  switch (options.kind.detector) {
    case DetectorKind::Orb:
    case DetectorKind::Agast:
      return std::nullopt;
    case DetectorKind::Fast:
      return options.fast.non_max_suppression ? std::optional(1.0) : std::nullopt;
    case DetectorKind::Sift:
      return options.sift.layers_per_octave;  // OpenCV spreads the contrast over the layers
    default:
      return 1.0;
  }
}

/// How many of the strongest to keep: those of the given threshold when that is within the bounds, else the nearest bound.
/// Responses that are equal are kept or dropped together, so that the choice is that of a threshold.
std::size_t num_kept(const std::vector<float>& responses, double threshold, const AdaptiveOptions& adaptive) {
  const auto at_least = [&](double response) {
    const auto end = std::partition_point(responses.begin(), responses.end(), [&](float r) { return r >= response; });
    return static_cast<std::size_t>(end - responses.begin());
  };
  const auto least = static_cast<std::size_t>(adaptive.min_features), most = static_cast<std::size_t>(adaptive.max_features);
  const std::size_t given = at_least(threshold);
  if (given < least) return responses.size() <= least ? responses.size() : at_least(responses[least - 1]);
  if (given <= most) return given;
  const auto weakest = responses[most - 1];
  if (responses[most] != weakest) return most;
  const auto stronger = static_cast<std::size_t>(
      std::partition_point(responses.begin(), responses.end(), [&](float r) { return r > weakest; }) - responses.begin());
  return stronger >= least ? stronger : at_least(weakest);
}

std::vector<cv::KeyPoint> cut_by_response(const cv::Mat& image, const FeatureOptions& options, double factor) {
  const double threshold = detection_threshold(options);
  std::vector<cv::KeyPoint> keypoints = detect(image, options, threshold * options.adaptive->min_threshold_ratio);
  std::vector<float> responses;
  responses.reserve(keypoints.size());
  for (const cv::KeyPoint& keypoint : keypoints) responses.push_back(keypoint.response);
  std::sort(responses.begin(), responses.end(), std::greater<>());
  const std::size_t kept = num_kept(responses, threshold / factor, *options.adaptive);
  if (kept == keypoints.size()) return keypoints;
  std::erase_if(keypoints, [&, weakest = responses[kept]](const cv::KeyPoint& keypoint) { return keypoint.response <= weakest; });
  return keypoints;
}

/// Whether `count` comes nearer to what is wanted than `other`: enough before too few, then the fewer too many, then the more.
bool is_nearer(std::size_t count, std::size_t other, std::size_t wanted) {
  if ((count >= wanted) != (other >= wanted)) return count >= wanted;
  return count >= wanted ? count < other : count > other;
}

std::vector<cv::KeyPoint> bisect(const cv::Mat& image, const FeatureOptions& options) {
  constexpr double kHighest = 255.0;  // grey levels: all that are bisected have them as their unit
  const AdaptiveOptions& adaptive = *options.adaptive;
  const auto least = static_cast<std::size_t>(adaptive.min_features), most = static_cast<std::size_t>(adaptive.max_features);
  double threshold = std::clamp(detection_threshold(options), 1.0, kHighest);
  double low = std::max(1.0, threshold * adaptive.min_threshold_ratio), high = kHighest;
  bool is_low_tried = false;
  std::optional<std::vector<cv::KeyPoint>> best;
  for (int i = 0; i < adaptive.max_iterations; ++i) {
    std::vector<cv::KeyPoint> keypoints = detect(image, options, threshold);
    const std::size_t count = keypoints.size();
    if (!best || is_nearer(count, best->size(), least)) best = std::move(keypoints);
    if (count >= least && count <= most) break;
    is_low_tried |= std::lround(threshold) == std::lround(low);
    (count < least ? high : low) = threshold;
    is_low_tried |= count > most;
    if (std::lround(high) - std::lround(low) > 1) {
      threshold = std::sqrt(low * high);
    } else if (!is_low_tried) {
      threshold = low;  // thresholds are whole numbers, and only the lowest is left
    } else {
      break;
    }
  }
  return *best;
}

}  // namespace

std::vector<cv::KeyPoint> detect_adaptively(const cv::Mat& image, const FeatureOptions& options) {
  assert(options.adaptive);
  const std::optional<double> factor = threshold_per_response(options);
  return factor ? cut_by_response(image, options, *factor) : bisect(image, options);
}

}  // namespace fabloop
