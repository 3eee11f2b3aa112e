// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/feature_report.h"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "frontend/features/feature_picture.h"
#include "tests/frontend/features/textures.h"

namespace fabloop {
namespace {

FeatureOptions few_sift() {
  FeatureOptions options;
  options.max_features = 200;
  options.clahe_clip_limit.reset();
  return options;
}

std::vector<SeenImage> see(const std::vector<cv::Mat>& images, const FeatureOptions& options = few_sift()) {
  return see_images(
      images.size(), [&](std::size_t i) { return images[i]; }, options, 2);
}

TEST(FeatureReport, OfImagesThatAreAlikeSaysThatAllIsFoundAgain) {
  const cv::Mat image = testing_support::ground(200, 160, 40, 31);
  const FeatureReport report = report_features({}, see({image, image, image}));
  EXPECT_EQ(report.num_images, 3u);
  EXPECT_EQ(report.num_pairs, 2u);
  EXPECT_EQ(report.num_related_pairs, 2u);
  EXPECT_NEAR(*report.repeatability, 1.0, 1e-12);
  EXPECT_NEAR(report.mean_features, static_cast<double>(report.min_features), 1e-9);
  EXPECT_GT(report.mean_matches, 0.7 * report.mean_features);
  EXPECT_GT(report.median_time_s, 0.0);
}

TEST(FeatureReport, FindsFeaturesAgainInAnImageThatIsTurnedAndEnlarged) {
  const cv::Mat scene = testing_support::ground(300, 300, 40, 32);
  cv::Mat turned;
  cv::warpAffine(scene, turned, cv::getRotationMatrix2D({150, 150}, 20, 1.2), scene.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
  const cv::Rect inner(50, 50, 200, 200);
  const FeatureReport report = report_features({}, see({scene(inner).clone(), turned(inner).clone()}));
  EXPECT_EQ(report.num_related_pairs, 1u);
  EXPECT_GT(*report.repeatability, 0.5);
  EXPECT_LT(*report.repeatability, 1.0);
}

TEST(FeatureReport, OfImagesThatShowOtherThingsHasNoRepeatability) {
  const FeatureReport report =
      report_features({}, see({testing_support::ground(160, 160, 40, 33), testing_support::ground(160, 160, 40, 34)}));
  EXPECT_EQ(report.num_related_pairs, 0u);
  EXPECT_FALSE(report.repeatability.has_value());
  EXPECT_THAT(report_table({report}), ::testing::HasSubstr("| n/a | 0/1 |"));
}

TEST(FeatureReport, TakesImagesWithoutFeaturesAndSingleImages) {
  const cv::Mat flat(50, 60, CV_8UC1, cv::Scalar(9));
  for (const char* name : {"sift", "orb"}) {
    FeatureOptions options = few_sift();
    options.kind = *feature_kind_from_string(name);
    const FeatureReport report = report_features(options.kind, see({flat, flat}, options));
    EXPECT_EQ(report.min_features, 0u);
    EXPECT_EQ(report.mean_coverage, 0.0);
  }
  EXPECT_EQ(report_features({}, see({flat})).num_pairs, 0u);
  EXPECT_EQ(report_features({}, {}).num_images, 0u);
}

TEST(FeatureReport, CoverageIsTheShareOfCells) {
  const cv::Size size(160, 120);
  std::vector<cv::KeyPoint> keypoints;
  EXPECT_EQ(coverage(keypoints, size), 0.0);
  for (int i = 0; i < 16 * 6; ++i)
    keypoints.emplace_back(static_cast<float>(10 * (i % 16)), static_cast<float>(10 * (i / 16)), 1.0F);
  EXPECT_EQ(coverage(keypoints, size), 0.5);
  keypoints.emplace_back(-3.0F, 500.0F, 1.0F);
  EXPECT_NEAR(coverage(keypoints, size), 0.5 + 1.0 / 192.0, 1e-12);
}

TEST(FeaturePicture, ShowsFeaturesOnImagesOfAnySize) {
  const std::vector<cv::KeyPoint> keypoints = {{0.0F, 0.0F, 5.0F, 30.0F}, {3.0F, 2.0F, 400.0F}, {1e4F, 1e4F, 2.0F}};
  std::vector<cv::Mat> pictures;
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(64, 48), cv::Size(48, 64), cv::Size(2000, 3)}) {
    const cv::Mat image(size, CV_8UC1, cv::Scalar(100));
    pictures.push_back(draw_features(image, {}, keypoints, "sift", {.longer_side_px = 300}));
    EXPECT_EQ(pictures.back().type(), CV_8UC3);
    EXPECT_GT(cv::norm(pictures.back(), draw_features(image, {}, {}, "sift", {.longer_side_px = 300}), cv::NORM_INF), 0.0);
  }
  const cv::Mat all = montage(pictures, 3, 100);
  EXPECT_EQ(all.cols, 3 * 108 + 8);
}

}  // namespace
}  // namespace fabloop
