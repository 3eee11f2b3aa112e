// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/panorama.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fabloop {
namespace {

constexpr int kWidth = 512, kHeight = 128;

/// Smooth blobs of several sizes that go on across the seam.
cv::Mat panorama() {
  cv::Mat noise(kHeight, kWidth, CV_8UC1);
  cv::RNG random(5);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::Mat wide, blurred, result;
  cv::copyMakeBorder(noise, wide, 0, 0, 64, 64, cv::BORDER_WRAP);
  cv::GaussianBlur(wide, blurred, {}, 3.0);
  cv::normalize(blurred, result, 0, 255, cv::NORM_MINMAX, CV_8U);
  return result(cv::Rect(64, 0, kWidth, kHeight)).clone();
}

cv::Mat rolled(const cv::Mat& image, int columns) {
  cv::Mat result(image.size(), image.type());
  for (int x = 0; x < image.cols; ++x) image.col(x).copyTo(result.col((x + columns) % image.cols));
  return result;
}

FeatureOptions plain_options() {
  FeatureOptions options;
  options.max_features = 100000;     // all, so that none is chosen by where it lies
  options.clahe_clip_limit.reset();  // its tiles do not roll
  return options;
}

/// The part of `features` that has its like, moved by the columns, in `others`.
double share_found(const Features& features, const Features& others, int columns) {
  constexpr float kSamePx = 0.01F;
  constexpr double kSameDescriptor = 1e-3;
  std::size_t num_found = 0;
  for (std::size_t i = 0; i < features.keypoints.size(); ++i) {
    const float wanted = std::fmod(features.keypoints[i].pt.x + static_cast<float>(columns), static_cast<float>(kWidth));
    for (std::size_t j = 0; j < others.keypoints.size(); ++j) {
      const float dx = std::abs(others.keypoints[j].pt.x - wanted);
      const bool same_spot = std::min(dx, static_cast<float>(kWidth) - dx) < kSamePx &&
                             std::abs(others.keypoints[j].pt.y - features.keypoints[i].pt.y) < kSamePx;
      if (!same_spot) continue;
      if (cv::norm(features.descriptors.row(static_cast<int>(i)), others.descriptors.row(static_cast<int>(j))) > kSameDescriptor)
        continue;
      ++num_found;
      break;
    }
  }
  return static_cast<double>(num_found) / static_cast<double>(features.keypoints.size());
}

// Octaves take every second pixel of the last, so that only columns that all octaves divide leave the same pixels.
constexpr int kRolledBy = kWidth / 2;

TEST(Panorama, RollingTheImageRollsItsFeatures) {
  const FeatureExtractor extractor(plain_options());
  const Features features = extract_panorama(extractor, panorama());
  const Features of_rolled = extract_panorama(extractor, rolled(panorama(), kRolledBy));
  ASSERT_GT(features.keypoints.size(), 200u);
  EXPECT_EQ(features.keypoints.size(), of_rolled.keypoints.size());
  // The largest octaves blur further than the continuation reaches.
  constexpr double kMostShare = 0.99;
  EXPECT_GT(share_found(features, of_rolled, kRolledBy), kMostShare);
}

TEST(Panorama, TheSeamIsLikeAnyOtherPlace) {
  const FeatureExtractor extractor(plain_options());
  const auto near_seam = [](const Features& features) {
    return std::count_if(features.keypoints.begin(), features.keypoints.end(),
                         [](const cv::KeyPoint& keypoint) { return keypoint.pt.x < 8 || keypoint.pt.x >= kWidth - 8; });
  };
  const auto at_middle = [](const Features& features) {
    return std::count_if(features.keypoints.begin(), features.keypoints.end(),
                         [](const cv::KeyPoint& keypoint) { return std::abs(keypoint.pt.x - kWidth / 2) < 8; });
  };
  const Features of_rolled = extract_panorama(extractor, rolled(panorama(), kRolledBy));
  EXPECT_EQ(near_seam(extract_panorama(extractor, panorama())), at_middle(of_rolled));
  EXPECT_GT(near_seam(extract_panorama(extractor, panorama())), near_seam(extractor.extract(panorama())));
}

TEST(Panorama, KeypointsLieInTheImageOnce) {
  FeatureOptions options;
  options.max_features = 150;
  const Features features = extract_panorama(FeatureExtractor(options), panorama());
  EXPECT_LE(features.keypoints.size(), 150u);
  EXPECT_GT(features.keypoints.size(), 100u);
  EXPECT_EQ(features.descriptors.rows, static_cast<int>(features.keypoints.size()));
  for (const cv::KeyPoint& keypoint : features.keypoints) {
    EXPECT_GE(keypoint.pt.x, -0.5F);
    EXPECT_LT(keypoint.pt.x, kWidth - 0.5F);
  }
}

TEST(Panorama, AnImageWithoutTextureHasNoFeatures) {
  const Features features = extract_panorama(FeatureExtractor(), cv::Mat(48, 64, CV_8UC1, cv::Scalar(90)));
  EXPECT_TRUE(features.keypoints.empty());
  EXPECT_EQ(features.descriptors.rows, 0);
}

}  // namespace
}  // namespace fabloop
