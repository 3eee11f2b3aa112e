// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "frontend/features/feature_extractor.h"
#include "frontend/features/surf.h"
#include "tests/frontend/features/textures.h"

namespace fabloop {
namespace {

constexpr int kLeast = 60, kMost = 90;

FeatureOptions adaptive_options(const FeatureKind& kind) {
  FeatureOptions options;
  options.kind = kind;
  options.max_features = 2000;
  options.clahe_clip_limit.reset();
  options.adaptive.emplace().min_features = kLeast;
  options.adaptive->max_features = kMost;
  options.adaptive->min_threshold_ratio = 0.02;
  return options;
}

std::size_t count(const FeatureOptions& options, const cv::Mat& image) {
  return FeatureExtractor(options).extract(image).keypoints.size();
}

std::vector<FeatureKind> detectors() {
  std::vector<FeatureKind> kinds = default_feature_kinds();
  std::erase_if(kinds, [](const FeatureKind& kind) {
    const bool is_absent = surf_library().empty() && kind.detector == DetectorKind::Surf;
    return is_absent || kind.detector == DetectorKind::Kaze;  // which is slow, and as AKAZE
  });
  for (FeatureKind& kind : kinds) {
    // Of these every detector's keypoints can be described wherever they are.
    if (kind.detector != DetectorKind::Orb) kind.descriptor = DescriptorKind::Sift;
  }
  return kinds;
}

TEST(AdaptiveDetection, ReachesTheWantedNumberOnRichAndOnPoorTexture) {
  for (const double contrast : {45.0, 7.0}) {
    const cv::Mat image = testing_support::ground(200, 160, contrast, 21);
    for (const FeatureKind& kind : detectors()) {
      if (kind.detector == DetectorKind::Mser) continue;  // regions are few whatever the contrast: see below
      const std::size_t number = count(adaptive_options(kind), image);
      EXPECT_GE(number, static_cast<std::size_t>(kLeast)) << to_string(kind) << ' ' << contrast;
      EXPECT_LE(number, static_cast<std::size_t>(kMost)) << to_string(kind) << ' ' << contrast;
    }
  }
}

TEST(AdaptiveDetection, EndsAtTheLowestThresholdWhereTextureIsTooPoor) {
  const cv::Mat image = testing_support::ground(200, 160, 2.0, 22);
  for (const FeatureKind& kind : detectors()) {
    FeatureOptions options = adaptive_options(kind);
    options.adaptive->min_features = 19000;
    options.adaptive->max_features = 20000;
    options.max_features = 20000;
    FeatureOptions lowest = options;
    lowest.adaptive.reset();
    lowest.detection_threshold = detection_threshold(options) * options.adaptive->min_threshold_ratio;
    if (kind.detector == DetectorKind::Orb || kind.detector == DetectorKind::Agast)
      lowest.detection_threshold = 1.0;  // a grey level
    EXPECT_EQ(count(options, image), count(lowest, image)) << to_string(kind);
  }
}

TEST(AdaptiveDetection, KeepsTheGivenThresholdWhereItsNumberIsWanted) {
  const cv::Mat image = testing_support::ground(200, 160, 30.0, 23);
  for (const FeatureKind& kind : detectors()) {
    FeatureOptions options = adaptive_options(kind);
    FeatureOptions fixed = options;
    fixed.adaptive.reset();
    const auto number = static_cast<int>(count(fixed, image));
    options.adaptive->min_features = std::max(1, number - 5);
    options.adaptive->max_features = number + 5;
    // A lower threshold lets candidates through that SIFT and the scale-space detectors then refine to a stronger place.
    EXPECT_NEAR(static_cast<double>(count(options, image)), number, 5) << to_string(kind);
  }
}

TEST(AdaptiveDetection, IsThatOfAThreshold) {
  const cv::Mat image = testing_support::ground(200, 160, 45.0, 24);
  const FeatureOptions options = adaptive_options(*feature_kind_from_string("fast+sift"));
  const Features features = FeatureExtractor(options).extract(image);
  FeatureOptions fixed = options;
  fixed.adaptive.reset();
  fixed.detection_threshold = features.keypoints.back().response;
  EXPECT_EQ(count(fixed, image), features.keypoints.size());
}

TEST(AdaptiveDetection, SteersCornersWithoutSuppressionToo) {
  FeatureOptions options = adaptive_options(*feature_kind_from_string("fast+sift"));
  options.fast.non_max_suppression = false;
  options.adaptive->max_features = 200;
  const std::size_t number = count(options, testing_support::ground(200, 160, 30.0, 25));
  EXPECT_GE(number, static_cast<std::size_t>(kLeast));
  EXPECT_LE(number, 200u);
}

}  // namespace
}  // namespace fabloop
