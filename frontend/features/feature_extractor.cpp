// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/feature_extractor.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "frontend/features/adaptive_detection.h"
#include "frontend/features/descriptors.h"
#include "frontend/features/detectors.h"
#include "frontend/features/spatially_even.h"
#include "frontend/features/surf.h"
#include "frontend/within_side.h"

namespace fabloop {
namespace {

cv::Mat equalized(const cv::Mat& gray, const std::optional<double>& clip_limit) {
  if (!clip_limit) return gray;
  cv::Mat result;
  cv::createCLAHE(*clip_limit, cv::Size(8, 8))->apply(gray, result);
  return result;
}

std::vector<std::size_t> evenly(const std::vector<cv::KeyPoint>& keypoints, const cv::Mat& image, const FeatureOptions& options) {
  const int most = options.adaptive ? std::min(options.max_features, options.adaptive->max_features) : options.max_features;
  return spatially_even(keypoints, image.size(), static_cast<std::size_t>(most));
}

/// Whether describing everything that is detected costs less than looking at the image twice: SIFT's and BRISK's descriptors
/// cost more than their scale space, and in adaptive mode most of what is detected is cut off.
bool describes_at_once(const FeatureOptions& options) {
  const bool is_own = to_string(options.kind.detector) == to_string(options.kind.descriptor);
  const bool is_cheap = options.kind.detector == DetectorKind::Orb || options.kind.detector == DetectorKind::Akaze ||
                        options.kind.detector == DetectorKind::Kaze;
  return is_own && is_cheap && !options.adaptive && options.orientation == Orientation::Dominant;
}

Features describe_all_then_choose(const cv::Mat& image, const FeatureOptions& options) {
  Features features;
  features.descriptor_kind = options.kind.descriptor;
  std::vector<cv::KeyPoint> detected;
  cv::Mat descriptors;
  if (std::min(image.rows, image.cols) >= least_image_side(options.kind.detector)) {
    make_opencv_detector(options, detection_threshold(options))->detectAndCompute(image, cv::noArray(), detected, descriptors);
  }
  const std::vector<std::size_t> kept = evenly(detected, image, options);
  const DescriptorLayout layout = descriptor_layout(options.kind.descriptor);
  features.descriptors.create(static_cast<int>(kept.size()), layout.size, layout.cv_type);
  for (std::size_t row = 0; row < kept.size(); ++row) {
    features.keypoints.push_back(detected[kept[row]]);
    descriptors.row(static_cast<int>(kept[row])).copyTo(features.descriptors.row(static_cast<int>(row)));
  }
  return features;
}

Features choose_then_describe(const cv::Mat& image, const FeatureOptions& options) {
  std::vector<cv::KeyPoint> detected =
      options.adaptive ? detect_adaptively(image, options) : detect(image, options, detection_threshold(options));
  erase_undescribable(detected, image.size(), options);
  std::vector<cv::KeyPoint> chosen;
  for (const std::size_t i : evenly(detected, image, options)) chosen.push_back(detected[i]);
  return describe(image, std::move(chosen), options);
}

/// Features of an image of `from` as those of the same image at `to`; pixel centres are at integers.
void move_to_size(Features& features, cv::Size from, cv::Size to) {
  if (from == to) return;
  const float x = static_cast<float>(to.width) / static_cast<float>(from.width);
  const float y = static_cast<float>(to.height) / static_cast<float>(from.height);
  features.pixel_size *= x;
  for (cv::KeyPoint& keypoint : features.keypoints) {
    keypoint.pt = {(keypoint.pt.x + 0.5f) * x - 0.5f, (keypoint.pt.y + 0.5f) * y - 0.5f};
    keypoint.size *= x;
  }
}

/// Drops what has a descriptor with NaN or infinity, which compares with nothing.
void keep_finite(Features& features) {
  if (features.descriptors.type() != CV_32F || cv::checkRange(features.descriptors)) return;
  Features finite;
  finite.descriptor_kind = features.descriptor_kind;
  finite.pixel_size = features.pixel_size;
  finite.descriptors.create(0, features.descriptors.cols, CV_32F);
  for (std::size_t i = 0; i < features.keypoints.size(); ++i) {
    const cv::Mat row = features.descriptors.row(static_cast<int>(i));
    if (!cv::checkRange(row)) continue;
    finite.keypoints.push_back(features.keypoints[i]);
    finite.descriptors.push_back(row);
  }
  features = std::move(finite);
}

}  // namespace

FeatureExtractor::FeatureExtractor(const FeatureOptions& options) : options_(options) {
  validate(options);
  if (options.kind.detector == DetectorKind::Surf || options.kind.descriptor == DescriptorKind::Surf) require_surf();
}

Features FeatureExtractor::extract(const cv::Mat& gray) const {
  assert(!gray.empty() && gray.type() == CV_8UC1 && "extract() takes an 8-bit grey image");
  const cv::Mat image = equalized(within_side(gray, options_.max_side_px), options_.clahe_clip_limit);
  Features features =
      describes_at_once(options_) ? describe_all_then_choose(image, options_) : choose_then_describe(image, options_);
  keep_finite(features);
  move_to_size(features, image.size(), gray.size());
  return features;
}

}  // namespace fabloop
