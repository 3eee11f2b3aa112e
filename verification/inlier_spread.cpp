// SPDX-License-Identifier: BSD-3-Clause
#include "verification/inlier_spread.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <opencv2/imgproc.hpp>

namespace fabloop {
namespace {

/// The component-wise median, the upper one of an even number.
cv::Point2f middle_of(std::span<const cv::Point2f> points) {
  std::vector<float> x, y;
  for (const cv::Point2f& point : points) {
    x.push_back(point.x);
    y.push_back(point.y);
  }
  const auto half = static_cast<std::ptrdiff_t>(points.size() / 2);
  std::nth_element(x.begin(), x.begin() + half, x.end());
  std::nth_element(y.begin(), y.begin() + half, y.end());
  return {x[points.size() / 2], y[points.size() / 2]};
}

double hull_share(std::span<const cv::Point2f> points, cv::Size image, double outliers) {
  const cv::Point2f middle = middle_of(points);
  std::vector<cv::Point2f> kept(points.begin(), points.end());
  std::stable_sort(kept.begin(), kept.end(),
                   [&](const auto& a, const auto& b) { return cv::norm(a - middle) < cv::norm(b - middle); });
  kept.resize(kept.size() - static_cast<std::size_t>(outliers * static_cast<double>(kept.size())));
  std::vector<cv::Point2f> hull;
  cv::convexHull(kept, hull);
  return cv::contourArea(hull) / static_cast<double>(image.area());
}

double cell_share(std::span<const cv::Point2f> points, cv::Size image, int grid_size) {
  std::vector<char> is_hit(static_cast<std::size_t>(grid_size) * static_cast<std::size_t>(grid_size), 0);
  // Pixel centres are at integers, so the image begins half a pixel before its first one.
  const auto cell = [&](float position, int size) {
    const double share = (static_cast<double>(position) + 0.5) / size;
    return static_cast<std::size_t>(std::clamp(static_cast<int>(share * grid_size), 0, grid_size - 1));
  };
  for (const cv::Point2f& point : points) {
    is_hit[cell(point.y, image.height) * static_cast<std::size_t>(grid_size) + cell(point.x, image.width)] = 1;
  }
  const auto num_hit = static_cast<double>(std::count(is_hit.begin(), is_hit.end(), char{1}));
  return num_hit / static_cast<double>(is_hit.size());
}

ImageSpread spread_in(const View& view, const std::vector<Match>& inliers, int Match::*index,
                      const InlierSpreadOptions& options) {
  std::vector<cv::Point2f> points;
  points.reserve(inliers.size());
  for (const Match& inlier : inliers) points.push_back(view.features.keypoints[static_cast<std::size_t>(inlier.*index)].pt);
  return image_spread(points, {view.camera.width, view.camera.height}, options);
}

}  // namespace

ImageSpread image_spread(std::span<const cv::Point2f> points, cv::Size image, const InlierSpreadOptions& options) {
  assert(image.area() > 0 && options.grid_size > 0 && options.hull_outliers >= 0 && options.hull_outliers < 1);
  if (points.empty()) return {};
  return {hull_share(points, image, options.hull_outliers), cell_share(points, image, options.grid_size)};
}

InlierSpread inlier_spread(const View& query, const View& match, const std::vector<Match>& inliers,
                           const InlierSpreadOptions& options) {
  return {spread_in(query, inliers, &Match::query, options), spread_in(match, inliers, &Match::match, options)};
}

}  // namespace fabloop
