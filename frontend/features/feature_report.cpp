// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/feature_report.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <opencv2/calib3d.hpp>
#include <utility>

#include "frontend/features/descriptor_distances.h"
#include "frontend/features/detectors.h"
#include "frontend/features/feature_extractor.h"
#include "frontend/parallel.h"

namespace fabloop {
namespace {

using Matches = std::vector<std::pair<int, int>>;

cv::Mat1f distances_between(const Features& a, const Features& b) {
  cv::Mat1f distances;
  if (a.descriptors.type() == CV_32F) {
    cv::sqrt(PackedDescriptors(b.descriptors).squared_distances(a.descriptors), distances);
  } else {
    cv::Mat counts;
    cv::batchDistance(a.descriptors, b.descriptors, counts, CV_32S, cv::noArray(), cv::NORM_HAMMING);
    counts.convertTo(distances, CV_32F);
  }
  return distances;
}

/// Matches that are each other's nearest and pass the ratio test; of one spot's several features, the others are no rivals.
Matches distinctive_matches(const Features& a, const Features& b, double max_ratio) {
  Matches matches;
  if (a.keypoints.empty() || b.keypoints.empty()) return matches;
  const cv::Mat1f distances = distances_between(a, b);
  std::vector<int> nearest_of_b(b.keypoints.size(), 0);
  for (int i = 1; i < distances.rows; ++i) {
    for (int j = 0; j < distances.cols; ++j) {
      int& nearest = nearest_of_b[static_cast<std::size_t>(j)];
      if (distances(i, j) < distances(nearest, j)) nearest = i;
    }
  }
  constexpr double kSameSpotPx = 2.0;
  for (int i = 0; i < distances.rows; ++i) {
    const float* row = distances[i];
    const int best = static_cast<int>(std::min_element(row, row + distances.cols) - row);
    if (nearest_of_b[static_cast<std::size_t>(best)] != i) continue;
    const cv::Point2f spot = b.keypoints[static_cast<std::size_t>(best)].pt;
    float second = std::numeric_limits<float>::infinity();
    for (int j = 0; j < distances.cols; ++j) {
      if (row[j] < second && cv::norm(b.keypoints[static_cast<std::size_t>(j)].pt - spot) > kSameSpotPx) second = row[j];
    }
    if (row[best] <= max_ratio * second) matches.emplace_back(i, best);
  }
  return matches;
}

struct Homography {
  cv::Matx33d b_from_a;
  std::size_t num_inliers = 0;
};

std::optional<Homography> relate(const Features& a, const Features& b, const Matches& matches,
                                 const FeatureReportOptions& options) {
  if (matches.size() < std::max<std::size_t>(4, options.min_inliers)) return std::nullopt;
  std::vector<cv::Point2f> in_a, in_b;
  for (const auto& [i, j] : matches) {
    in_a.push_back(a.keypoints[static_cast<std::size_t>(i)].pt);
    in_b.push_back(b.keypoints[static_cast<std::size_t>(j)].pt);
  }
  cv::Mat is_inlier;
  const cv::Mat found = cv::findHomography(in_a, in_b, cv::RANSAC, options.max_error_px * b.pixel_size, is_inlier);
  if (found.empty()) return std::nullopt;
  const Homography homography{cv::Matx33d(found), static_cast<std::size_t>(cv::countNonZero(is_inlier))};
  if (homography.num_inliers < options.min_inliers || !cv::checkRange(found)) return std::nullopt;
  return homography;
}

struct CarriedPoint {
  cv::Point2d point;
  double scale = 1;  ///< Of lengths, there.
};

std::optional<CarriedPoint> carry(const cv::Matx33d& h, const cv::Point2f& p) {
  const cv::Vec3d v = h * cv::Vec3d(p.x, p.y, 1.0);
  if (v[2] <= 1e-9) return std::nullopt;
  // The area's factor under a homography at p is det H / w^3.
  const double area = cv::determinant(h) / (v[2] * v[2] * v[2]);
  return CarriedPoint{{v[0] / v[2], v[1] / v[2]}, std::sqrt(std::abs(area))};
}

std::optional<double> share_found_again(const FeatureKind& kind, const SeenImage& a, const SeenImage& b,
                                        const cv::Matx33d& b_from_a, const FeatureReportOptions& options) {
  const double reach = options.max_error_px * b.features.pixel_size;
  std::size_t num_inside = 0, num_found = 0;
  for (const cv::KeyPoint& keypoint : a.features.keypoints) {
    const std::optional<CarriedPoint> carried = carry(b_from_a, keypoint.pt);
    if (!carried || !cv::Rect2d(0, 0, b.size.width, b.size.height).contains(carried->point)) continue;
    ++num_inside;
    const double size = spot_size(kind.detector, keypoint) * carried->scale;
    num_found += std::any_of(b.features.keypoints.begin(), b.features.keypoints.end(), [&](const cv::KeyPoint& other) {
      const double dx = other.pt.x - carried->point.x, dy = other.pt.y - carried->point.y;
      if (dx * dx + dy * dy > reach * reach) return false;
      const double ratio = spot_size(kind.detector, other) / size;
      return ratio <= options.max_size_ratio && ratio * options.max_size_ratio >= 1.0;
    });
  }
  if (num_inside == 0) return std::nullopt;
  return static_cast<double>(num_found) / static_cast<double>(num_inside);
}

struct PairFigures {
  std::size_t num_matches = 0;
  std::optional<std::size_t> num_inliers;
  std::optional<double> repeatability;
};

PairFigures measure_pair(const FeatureKind& kind, const SeenImage& a, const SeenImage& b, const FeatureReportOptions& options) {
  const Matches matches = distinctive_matches(a.features, b.features, options.max_ratio);
  PairFigures figures;
  figures.num_matches = matches.size();
  if (const auto homography = relate(a.features, b.features, matches, options)) {
    figures.num_inliers = homography->num_inliers;
    figures.repeatability = share_found_again(kind, a, b, homography->b_from_a, options);
  }
  return figures;
}

void add_pairs(const std::vector<PairFigures>& pairs, FeatureReport& report) {
  report.num_pairs = pairs.size();
  double repeatability = 0;
  std::size_t num_measured = 0;
  for (const PairFigures& pair : pairs) {
    report.mean_matches += static_cast<double>(pair.num_matches) / static_cast<double>(pairs.size());
    report.mean_inliers += static_cast<double>(pair.num_inliers.value_or(0)) / static_cast<double>(pairs.size());
    report.num_related_pairs += pair.num_inliers ? 1 : 0;
    num_measured += pair.repeatability ? 1 : 0;
    repeatability += pair.repeatability.value_or(0.0);
  }
  if (num_measured > 0) report.repeatability = repeatability / static_cast<double>(num_measured);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<SeenImage> see_images(std::size_t count, const ReadImage& read, const FeatureOptions& options, int num_threads,
                                  const Progress& progress) {
  using Clock = std::chrono::steady_clock;
  const FeatureExtractor extractor(options);
  const std::string stage = to_string(options.kind);
  std::vector<SeenImage> images(count);
  std::mutex progress_mutex;
  std::size_t num_done = 0;
  parallel_for(count, num_threads, [&](std::size_t i) {
    const cv::Mat gray = read(i);
    const Clock::time_point start = Clock::now();
    images[i] = {extractor.extract(gray), gray.size(), 0.0};
    images[i].time_s = std::chrono::duration<double>(Clock::now() - start).count();
    const std::lock_guard lock(progress_mutex);
    if (progress) progress(stage, ++num_done, count);
  });
  return images;
}

double coverage(const std::vector<cv::KeyPoint>& keypoints, const cv::Size& size) {
  std::array<char, static_cast<std::size_t>(kCoverageColumns * kCoverageRows)> is_covered{};
  const auto index = [](float coordinate, int extent, int cells) {
    return std::clamp(static_cast<int>((coordinate + 0.5F) * static_cast<float>(cells) / static_cast<float>(extent)), 0,
                      cells - 1);
  };
  for (const cv::KeyPoint& keypoint : keypoints) {
    const int column = index(keypoint.pt.x, size.width, kCoverageColumns), row = index(keypoint.pt.y, size.height, kCoverageRows);
    is_covered[static_cast<std::size_t>(row * kCoverageColumns + column)] = 1;
  }
  return static_cast<double>(std::count(is_covered.begin(), is_covered.end(), 1)) / static_cast<double>(is_covered.size());
}

FeatureReport report_features(const FeatureKind& kind, const std::vector<SeenImage>& images,
                              const FeatureReportOptions& options) {
  FeatureReport report;
  report.kind = kind;
  report.num_images = images.size();
  if (images.empty()) return report;
  report.min_features = std::numeric_limits<std::size_t>::max();
  std::vector<double> times_s;
  for (const SeenImage& image : images) {
    const std::size_t count = image.features.keypoints.size();
    report.mean_features += static_cast<double>(count) / static_cast<double>(images.size());
    report.min_features = std::min(report.min_features, count);
    report.mean_coverage += coverage(image.features.keypoints, image.size) / static_cast<double>(images.size());
    times_s.push_back(image.time_s);
  }
  report.median_time_s = median(times_s);
  std::vector<PairFigures> pairs(images.size() - 1);
  parallel_for(pairs.size(), options.num_threads,
               [&](std::size_t i) { pairs[i] = measure_pair(kind, images[i], images[i + 1], options); });
  add_pairs(pairs, report);
  return report;
}

}  // namespace fabloop
