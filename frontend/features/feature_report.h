// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "frontend/features/feature_options.h"
#include "frontend/features/features.h"
#include "frontend/progress.h"

namespace fabloop {

/// What one image showed, and how long looking took.
struct SeenImage {
  Features features;
  cv::Size size;
  double time_s = 0;  ///< Of extraction alone, on one thread.
};

/// Gives the i-th image (CV_8UC1). Called from several threads at once.
using ReadImage = std::function<cv::Mat(std::size_t i)>;

/// Extracts the features of `count` images on up to `num_threads` threads (0: all). Times are truest with one.
std::vector<SeenImage> see_images(std::size_t count, const ReadImage& read, const FeatureOptions& options, int num_threads = 0,
                                  const Progress& progress = {});

struct FeatureReportOptions {
  /// Lowe's ratio test (Lowe 2004, section 7.1), among each other's nearest: what counts as a distinctive match.
  double max_ratio = 0.8;
  /// How near to where it should be a keypoint is found again, and RANSAC's bound, in pixels of the image in which it was found.
  /// More where parallax bends the ground.
  double max_error_px = 3.0;
  /// How much its size may differ from what it should be.
  double max_size_ratio = 1.5;
  /// Least inliers of a homography that is believed.
  std::size_t min_inliers = 20;
  int num_threads = 0;  ///< 0: all. The result does not depend on it.
};

/// What a kind of features is worth on consecutive images.
struct FeatureReport {
  FeatureKind kind;
  std::size_t num_images = 0;
  double mean_features = 0;
  std::size_t min_features = 0;
  /// Mean share of the cells of a grid of kCoverageColumns x kCoverageRows over the image that hold a feature.
  double mean_coverage = 0;
  std::size_t num_pairs = 0;          ///< Consecutive images.
  std::size_t num_related_pairs = 0;  ///< Those whose matches gave a homography by RANSAC.
  double mean_matches = 0;            ///< Distinctive matches a pair.
  double mean_inliers = 0;            ///< Those of them, a pair, that agree with its homography.
  /// Mean over the related pairs of the share of the first image's keypoints which, carried over by the homography, lie in the
  /// second image and have one of its keypoints within max_error_px whose size fits. None without related pairs.
  std::optional<double> repeatability;
  double median_time_s = 0;  ///< An image.
};

inline constexpr int kCoverageColumns = 16, kCoverageRows = 12;

/// Share of the grid's cells that hold a keypoint.
double coverage(const std::vector<cv::KeyPoint>& keypoints, const cv::Size& size);

/// Measures what see_images() gave.
FeatureReport report_features(const FeatureKind& kind, const std::vector<SeenImage>& images,
                              const FeatureReportOptions& options = {});

/// "How it was measured", in one line, and the table of reports as Markdown and as CSV.
std::string report_recipe(const FeatureReportOptions& options);
std::string report_table(const std::vector<FeatureReport>& reports);
std::string report_csv(const std::vector<FeatureReport>& reports);

}  // namespace fabloop
