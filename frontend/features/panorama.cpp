// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/panorama.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <opencv2/core.hpp>

namespace fabloop {
namespace {

/// Columns that continue the image on each side: more than descriptors reach, but for the largest few.
int padding_of(const cv::Mat& gray) {
  constexpr int kLeast = 128;
  constexpr int kMostWidths = 8;
  return std::min(gray.cols, std::max(kLeast, gray.cols / kMostWidths));
}

/// As many features in the image itself as were asked for, and some in the continuation.
FeatureOptions options_for(const FeatureExtractor& extractor, int width, int padding) {
  FeatureOptions options = extractor.options();
  const double growth = 1.0 + 2.0 * padding / width;
  const double wanted = std::ceil(options.max_features * growth);
  options.max_side_px = static_cast<int>(std::min<double>(kLargestSidePx, std::ceil(options.max_side_px * growth)));
  constexpr double kMostOfPanorama = 1'000'000;
  options.max_features = static_cast<int>(std::min(wanted, kMostOfPanorama));
  return options;
}

}  // namespace

Features extract_panorama(const FeatureExtractor& extractor, const cv::Mat& gray) {
  assert(!gray.empty() && gray.type() == CV_8UC1 && "extract_panorama() takes an 8-bit grey image");
  const int padding = padding_of(gray);
  cv::Mat continued;
  cv::copyMakeBorder(gray, continued, 0, 0, padding, padding, cv::BORDER_WRAP);
  const Features all = FeatureExtractor(options_for(extractor, gray.cols, padding)).extract(continued);
  Features features;
  features.descriptor_kind = all.descriptor_kind;
  features.pixel_size = all.pixel_size;
  features.descriptors = cv::Mat(0, all.descriptors.cols, all.descriptors.type());
  const auto most = static_cast<std::size_t>(extractor.options().max_features);
  // Pixel centres are at integers, so the image begins half a pixel before its first one.
  constexpr float kHalfPixel = 0.5F;
  const auto begin = static_cast<float>(padding) - kHalfPixel;
  for (std::size_t i = 0; i < all.keypoints.size() && features.keypoints.size() < most; ++i) {
    cv::KeyPoint keypoint = all.keypoints[i];
    if (keypoint.pt.x < begin || keypoint.pt.x >= begin + static_cast<float>(gray.cols)) continue;
    keypoint.pt.x -= static_cast<float>(padding);
    features.keypoints.push_back(keypoint);
    features.descriptors.push_back(all.descriptors.row(static_cast<int>(i)));
  }
  return features;
}

Features extract(const FeatureExtractor& extractor, const cv::Mat& gray, ImageShape shape) {
  return shape == ImageShape::Panorama ? extract_panorama(extractor, gray) : extractor.extract(gray);
}

}  // namespace fabloop
