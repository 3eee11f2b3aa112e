// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/feature_extractor.h"

#include <array>
#include <cassert>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "frontend/error.h"
#include "frontend/features/spatially_even.h"

namespace fabloop {
namespace {

struct NamedKind {
  FeatureKind kind;
  std::string_view name;
};

constexpr std::array<NamedKind, 3> kNamedKinds{
    {{FeatureKind::Sift, "sift"}, {FeatureKind::Orb, "orb"}, {FeatureKind::Akaze, "akaze"}}};

/// ORB bounds its own count by strength alone, so it is asked for a surplus from which the even selection chooses.
constexpr int kOrbSurplus = 5;

/// Detectors hold scratch memory, so every call makes its own: that is cheap, and calls may run in parallel.
cv::Ptr<cv::Feature2D> make_detector(const FeatureOptions& options) {
  const double threshold = options.detection_threshold.value_or(default_detection_threshold(options.kind));
  switch (options.kind) {
    case FeatureKind::Orb: {
      cv::Ptr<cv::ORB> orb = cv::ORB::create(kOrbSurplus * options.max_features);
      orb->setFastThreshold(static_cast<int>(std::lround(threshold)));
      return orb;
    }
    case FeatureKind::Akaze: {
      cv::Ptr<cv::AKAZE> akaze = cv::AKAZE::create();
      akaze->setThreshold(threshold);
      return akaze;
    }
    case FeatureKind::Sift:
      break;
  }
  constexpr int kNoBound = 0;
  constexpr int kLayersPerOctave = 3;
  return cv::SIFT::create(kNoBound, kLayersPerOctave, threshold);
}

cv::Mat equalized(const cv::Mat& gray, const std::optional<double>& clip_limit) {
  if (!clip_limit) return gray;
  cv::Mat result;
  cv::createCLAHE(*clip_limit, cv::Size(8, 8))->apply(gray, result);
  return result;
}

void turn_into_root_sift(cv::Mat& descriptors) {
  for (int row = 0; row < descriptors.rows; ++row) {
    cv::Mat descriptor = descriptors.row(row);
    const double sum = cv::norm(descriptor, cv::NORM_L1);
    if (sum > 0) descriptor /= sum;
  }
  cv::sqrt(descriptors, descriptors);
}

/// The strongest of each part of the image, with their descriptors.
Features detect_evenly(cv::Feature2D& detector, const cv::Mat& image, const FeatureOptions& options) {
  Features features;
  features.kind = options.kind;
  std::vector<cv::KeyPoint> detected;
  cv::Mat descriptors;
  // SIFT's descriptors cost more than its scale space, so those that are dropped are not computed; with the others it is the
  // other way round.
  const bool describes_later = options.kind == FeatureKind::Sift;
  if (describes_later) {
    detector.detect(image, detected);
  } else {
    detector.detectAndCompute(image, cv::noArray(), detected, descriptors);
  }
  const auto kept = spatially_even(detected, image.size(), static_cast<std::size_t>(options.max_features));
  features.keypoints.reserve(kept.size());
  for (const std::size_t i : kept) features.keypoints.push_back(detected[i]);
  if (describes_later && !kept.empty()) {
    detector.compute(image, features.keypoints, features.descriptors);
    return features;
  }
  features.descriptors.create(static_cast<int>(kept.size()), detector.descriptorSize(), detector.descriptorType());
  for (std::size_t row = 0; row < kept.size(); ++row) {
    descriptors.row(static_cast<int>(kept[row])).copyTo(features.descriptors.row(static_cast<int>(row)));
  }
  return features;
}

}  // namespace

double default_detection_threshold(FeatureKind kind) {
  switch (kind) {
    case FeatureKind::Orb:
      return 7;
    case FeatureKind::Akaze:
      return 1e-4;
    case FeatureKind::Sift:
      break;
  }
  return 0.01;
}

FeatureExtractor::FeatureExtractor(const FeatureOptions& options) : options_(options) {
  const auto fail = [](const std::string& what) { throw InputError("feature options: " + what); };
  constexpr int kMostFeatures = 1'000'000;
  if (options.max_features < 1 || options.max_features > kMostFeatures) {
    fail("max_features is " + std::to_string(options.max_features) + "; give 1 to " + std::to_string(kMostFeatures));
  }
  if (options.detection_threshold && !(*options.detection_threshold >= 0 && std::isfinite(*options.detection_threshold))) {
    fail("detection_threshold is " + std::to_string(*options.detection_threshold) + "; give 0 or more");
  }
  if (options.clahe_clip_limit && !(*options.clahe_clip_limit > 0 && std::isfinite(*options.clahe_clip_limit))) {
    fail("clahe_clip_limit is " + std::to_string(*options.clahe_clip_limit) +
         "; give a positive number, or none to leave images as they are");
  }
}

Features FeatureExtractor::extract(const cv::Mat& gray) const {
  assert(!gray.empty() && gray.type() == CV_8UC1 && "extract() takes an 8-bit grey image");
  const cv::Mat image = equalized(gray, options_.clahe_clip_limit);
  Features features = detect_evenly(*make_detector(options_), image, options_);
  if (options_.kind == FeatureKind::Sift && options_.root_sift) turn_into_root_sift(features.descriptors);
  return features;
}

std::string_view to_string(FeatureKind kind) {
  for (const NamedKind& named : kNamedKinds) {
    if (named.kind == kind) return named.name;
  }
  assert(false && "a FeatureKind without a name");
  return {};
}

std::optional<FeatureKind> feature_kind_from_string(std::string_view name) {
  for (const NamedKind& named : kNamedKinds) {
    if (named.name == name) return named.kind;
  }
  return std::nullopt;
}

}  // namespace fabloop
