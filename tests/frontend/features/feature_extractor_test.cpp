// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/feature_extractor.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "frontend/error.h"
#include "frontend/parallel.h"

namespace fabloop {
namespace {

using testing::HasSubstr;

constexpr FeatureKind kKinds[] = {FeatureKind::Sift, FeatureKind::Orb, FeatureKind::Akaze};

/// Blobs of all sizes: strong contrast on the left third, an eighth of it on the right.
cv::Mat blobs() {
  cv::Mat image(240, 320, CV_8UC1, cv::Scalar(128));
  cv::RNG random(11);
  for (int i = 0; i < 1500; ++i) {
    const cv::Point centre(random.uniform(0, 320), random.uniform(0, 240));
    const int contrast = centre.x < 107 ? 100 : 12;
    cv::circle(image, centre, random.uniform(1, 5), cv::Scalar(128 + random.uniform(-contrast, contrast)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, {}, 0.8);
  return image;
}

FeatureOptions options_for(FeatureKind kind, int max_features = 300) {
  FeatureOptions options;
  options.kind = kind;
  options.max_features = max_features;
  return options;
}

bool same(const Features& a, const Features& b) {
  if (a.keypoints.size() != b.keypoints.size() || cv::norm(a.descriptors, b.descriptors, cv::NORM_INF) != 0) return false;
  return std::equal(
      a.keypoints.begin(), a.keypoints.end(), b.keypoints.begin(), [](const cv::KeyPoint& p, const cv::KeyPoint& q) {
        return p.pt == q.pt && p.size == q.size && p.angle == q.angle && p.response == q.response && p.octave == q.octave;
      });
}

/// Restores OpenCV's number of threads.
struct ThreadCount {
  int before = cv::getNumThreads();
  ~ThreadCount() { cv::setNumThreads(before); }
};

TEST(FeatureExtractor, GivesTheAskedNumberWithMatchingDescriptors) {
  const cv::Mat image = blobs();
  for (const FeatureKind kind : kKinds) {
    const Features features = FeatureExtractor(options_for(kind)).extract(image);
    EXPECT_EQ(features.kind, kind);
    EXPECT_LE(features.keypoints.size(), 300u);
    EXPECT_GE(features.keypoints.size(), 290u) << to_string(kind);
    EXPECT_EQ(features.descriptors.rows, static_cast<int>(features.keypoints.size()));
    EXPECT_EQ(features.descriptors.cols, kind == FeatureKind::Sift ? 128 : kind == FeatureKind::Orb ? 32 : 61);
    EXPECT_EQ(features.descriptors.type(), kind == FeatureKind::Sift ? CV_32F : CV_8U);
    for (std::size_t i = 1; i < features.keypoints.size(); ++i) {
      EXPECT_GE(features.keypoints[i - 1].response, features.keypoints[i].response);
    }
  }
}

TEST(FeatureExtractor, IsTheSameWhateverTheNumberOfThreads) {
  const ThreadCount restore;
  const cv::Mat image = blobs();
  for (const FeatureKind kind : kKinds) {
    const FeatureExtractor extractor(options_for(kind));
    cv::setNumThreads(1);
    const Features alone = extractor.extract(image);
    cv::setNumThreads(4);
    EXPECT_TRUE(same(alone, extractor.extract(image))) << to_string(kind);
    std::vector<Features> parallel(4);
    parallel_for(parallel.size(), 4, [&](std::size_t i) { parallel[i] = extractor.extract(image); });
    for (const Features& features : parallel) EXPECT_TRUE(same(alone, features)) << to_string(kind);
  }
}

TEST(FeatureExtractor, CoversFaintPartsOfTheImageToo) {
  const cv::Mat image = blobs();
  for (const FeatureKind kind : kKinds) {
    std::set<int> cells;
    for (const cv::KeyPoint& keypoint : FeatureExtractor(options_for(kind)).extract(image).keypoints) {
      cells.insert(static_cast<int>(keypoint.pt.y) / 60 * 10 + static_cast<int>(keypoint.pt.x) / 80);
    }
    EXPECT_EQ(cells.size(), 16u) << to_string(kind);
  }
}

TEST(FeatureExtractor, RootSiftIsOfUnitLength) {
  FeatureOptions options = options_for(FeatureKind::Sift);
  const Features root = FeatureExtractor(options).extract(blobs());
  for (int row = 0; row < root.descriptors.rows; ++row) EXPECT_NEAR(cv::norm(root.descriptors.row(row)), 1.0, 1e-5);
  options.root_sift = false;
  const Features plain = FeatureExtractor(options).extract(blobs());
  EXPECT_GT(cv::norm(plain.descriptors, cv::NORM_INF), 100.0);
  EXPECT_EQ(plain.keypoints.size(), root.keypoints.size());
}

TEST(FeatureExtractor, AFlatImageHasNoFeatures) {
  const cv::Mat flat(240, 320, CV_8UC1, cv::Scalar(90));
  for (const FeatureKind kind : kKinds) {
    const Features features = FeatureExtractor(options_for(kind)).extract(flat);
    EXPECT_TRUE(features.keypoints.empty()) << to_string(kind);
    EXPECT_EQ(features.descriptors.rows, 0);
  }
}

TEST(FeatureExtractor, OptionsOutOfRangeAreNamed) {
  const auto message = [](const FeatureOptions& options) -> std::string {
    try {
      const FeatureExtractor extractor(options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  FeatureOptions options;
  options.max_features = 0;
  EXPECT_THAT(message(options), HasSubstr("max_features"));
  options = {};
  options.detection_threshold = -1.0;
  EXPECT_THAT(message(options), HasSubstr("detection_threshold"));
  options = {};
  options.clahe_clip_limit = 0.0;
  EXPECT_THAT(message(options), HasSubstr("clahe_clip_limit"));
}

TEST(FeatureKind, NamesAreInverse) {
  for (const FeatureKind kind : kKinds) EXPECT_EQ(feature_kind_from_string(to_string(kind)), kind);
  EXPECT_FALSE(feature_kind_from_string("surf").has_value());
}

TEST(RealFeatures, LowContrastImagesGiveTheWantedNumber) {
  namespace fs = std::filesystem;
  const fs::path aerial = fs::path(FABLOOP_SHARED_DATA_DIR) / "aerial";
  if (!fs::exists(aerial)) GTEST_SKIP() << "real sequences are absent: " << aerial.string();
  for (const std::string name : {"caliterra/images/0000_IMG_9354.jpg", "seneca/images/0000_IMG_0446.jpg"}) {
    const cv::Mat image = cv::imread((aerial / name).string(), cv::IMREAD_GRAYSCALE);
    ASSERT_FALSE(image.empty()) << name;
    EXPECT_GE(FeatureExtractor().extract(image).keypoints.size(), 1490u) << name;
  }
}

}  // namespace
}  // namespace fabloop
