// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/feature_extractor.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "frontend/error.h"
#include "frontend/features/surf.h"
#include "frontend/parallel.h"
#include "tests/frontend/features/textures.h"

namespace fabloop {
namespace {

using ::testing::HasSubstr;

using ::fabloop::testing_support::blobs;
using ::fabloop::testing_support::ground;

/// Every detector with its default descriptor, but for SURF where it was not built in.
std::vector<FeatureKind> kinds() {
  std::vector<FeatureKind> result = default_feature_kinds();
  std::erase_if(result, [](const FeatureKind& kind) {
    return surf_library().empty() && (kind.detector == DetectorKind::Surf || kind.descriptor == DescriptorKind::Surf);
  });
  return result;
}

FeatureOptions options_for(const FeatureKind& kind, int max_features = 300) {
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

/// How many of 4 x 4 cells of the image hold a keypoint.
double num_cells(const std::vector<cv::KeyPoint>& keypoints, cv::Size size) {
  std::set<std::pair<int, int>> cells;
  for (const cv::KeyPoint& keypoint : keypoints) {
    cells.emplace(static_cast<int>(4 * keypoint.pt.x) / size.width, static_cast<int>(4 * keypoint.pt.y) / size.height);
  }
  return static_cast<double>(cells.size());
}

TEST(FeatureExtractor, GivesTheAskedNumberWithMatchingDescriptors) {
  const cv::Mat image = blobs();
  for (const FeatureKind& kind : kinds()) {
    const Features features = FeatureExtractor(options_for(kind)).extract(image);
    EXPECT_EQ(features.descriptor_kind, kind.descriptor);
    EXPECT_LE(features.keypoints.size(), 300u);
    const std::string name = to_string(kind);
    // The others find less on such small an image, or lose more at its edge.
    const bool finds_plenty = name == "sift" || name == "orb" || name == "akaze";
    EXPECT_GE(features.keypoints.size(), finds_plenty ? 290u : 25u) << name;
    ASSERT_EQ(features.descriptors.rows, static_cast<int>(features.keypoints.size()));
    EXPECT_EQ(features.descriptors.cols, descriptor_layout(kind.descriptor).size) << to_string(kind);
    EXPECT_EQ(features.descriptors.type(), descriptor_layout(kind.descriptor).cv_type) << to_string(kind);
    EXPECT_TRUE(features.descriptors.type() == CV_8U || cv::checkRange(features.descriptors)) << to_string(kind);
    const std::vector<cv::KeyPoint> first(
        features.keypoints.begin(), features.keypoints.begin() + static_cast<std::ptrdiff_t>(features.keypoints.size() / 2));
    EXPECT_GE(num_cells(first, image.size()), 0.8 * num_cells(features.keypoints, image.size())) << name;
  }
}

TEST(FeatureExtractor, IsTheSameWhateverTheNumberOfThreads) {
  const ThreadCount restore;
  const cv::Mat image = blobs()(cv::Rect(0, 0, 160, 160)).clone();
  for (FeatureKind kind : kinds()) {
    for (const bool is_adaptive : {false, true}) {
      FeatureOptions options = options_for(kind);
      if (is_adaptive) options.adaptive.emplace() = {40, 60, 5, 0.2};
      const FeatureExtractor extractor(options);
      cv::setNumThreads(1);
      const Features alone = extractor.extract(image);
      cv::setNumThreads(4);
      std::vector<Features> parallel(2);
      parallel_for(parallel.size(), 2, [&](std::size_t i) { parallel[i] = extractor.extract(image); });
      for (const Features& features : parallel) EXPECT_TRUE(same(alone, features)) << to_string(kind);
    }
  }
}

TEST(FeatureExtractor, CoversFaintPartsOfTheImageToo) {
  const cv::Mat image = blobs();
  for (const char* name : {"sift", "orb", "akaze", "brisk", "fast+orb", "gftt+sift"}) {
    std::set<int> cells;
    for (const cv::KeyPoint& keypoint : FeatureExtractor(options_for(*feature_kind_from_string(name))).extract(image).keypoints) {
      cells.insert(static_cast<int>(keypoint.pt.y) / 60 * 10 + static_cast<int>(keypoint.pt.x) / 80);
    }
    EXPECT_EQ(cells.size(), 16u) << name;
  }
}

/// Share of the features of an image whose nearest in the image turned by 90 degrees is at the same spot.
double share_found_in_turned(const FeatureOptions& options) {
  const cv::Mat image = ground(240, 240, 40, 9);
  cv::Mat turned;
  cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);
  const FeatureExtractor extractor(options);
  const Features a = extractor.extract(image), b = extractor.extract(turned);
  std::vector<cv::DMatch> matches;
  cv::BFMatcher(a.descriptors.type() == CV_8U ? cv::NORM_HAMMING : cv::NORM_L2, true)
      .match(a.descriptors, b.descriptors, matches);
  double num_right = 0;
  for (const cv::DMatch& match : matches) {
    const cv::Point2f p = a.keypoints[static_cast<std::size_t>(match.queryIdx)].pt;
    num_right += cv::norm(cv::Point2f(239.0F - p.y, p.x) - b.keypoints[static_cast<std::size_t>(match.trainIdx)].pt) < 3.0;
  }
  return num_right / static_cast<double>(a.keypoints.size());
}

TEST(FeatureExtractor, DescribesEveryDetectorsFeaturesTheSameWhenTheImageTurns) {
  for (const FeatureKind& kind : kinds()) {
    FeatureOptions options = options_for(kind, 150);
    options.clahe_clip_limit.reset();
    EXPECT_GT(share_found_in_turned(options), 0.5) << to_string(kind);
  }
}

TEST(FeatureExtractor, PairsAnyDetectorWithAnyDescriptorThatCanDescribeIt) {
  const cv::Mat image = ground(140, 140, 40, 10);
  for (const FeatureKind& detector : kinds()) {
    for (const FeatureKind& own : kinds()) {
      const FeatureKind kind{detector.detector, own.descriptor};
      const bool is_choosy = kind.descriptor == DescriptorKind::Akaze || kind.descriptor == DescriptorKind::Kaze;
      if (is_choosy && to_string(kind.detector) != to_string(kind.descriptor)) {
        EXPECT_THROW(FeatureExtractor{options_for(kind)}, InputError) << to_string(kind);
        continue;
      }
      const Features features = FeatureExtractor(options_for(kind, 40)).extract(image);
      EXPECT_GE(features.keypoints.size(), 5u) << to_string(kind);
      EXPECT_EQ(features.descriptors.rows, static_cast<int>(features.keypoints.size())) << to_string(kind);
    }
  }
}

TEST(FeatureExtractor, UprightFeaturesHaveNoAngle) {
  const cv::Mat image = ground(160, 160, 40, 11);
  for (const FeatureKind& kind : kinds()) {
    FeatureOptions options = options_for(kind, 50);
    options.orientation = Orientation::Upright;
    if (kind.descriptor == DescriptorKind::Brisk) {
      EXPECT_THROW(FeatureExtractor{options}, InputError);
      continue;
    }
    for (const cv::KeyPoint& keypoint : FeatureExtractor(options).extract(image).keypoints) {
      EXPECT_EQ(keypoint.angle, 0.0F) << to_string(kind);
    }
  }
}

TEST(FeatureExtractor, TakesImagesOfAnySize) {
  for (const cv::Size size :
       {cv::Size(1, 1), cv::Size(2, 3), cv::Size(7, 7), cv::Size(1, 90), cv::Size(90, 9), cv::Size(33, 33)}) {
    cv::Mat image(size, CV_8UC1);
    cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, 256);
    for (const FeatureKind& kind : kinds()) {
      for (const DescriptorKind descriptor :
           {kind.descriptor, DescriptorKind::Sift, DescriptorKind::Orb, DescriptorKind::Brisk}) {
        const Features features = FeatureExtractor(options_for({kind.detector, descriptor})).extract(image);
        EXPECT_EQ(features.descriptors.rows, static_cast<int>(features.keypoints.size())) << to_string(kind);
        EXPECT_EQ(features.descriptors.cols, descriptor_layout(descriptor).size) << to_string(kind);
      }
    }
  }
}

TEST(FeatureExtractor, LooksAtLargeImagesShrunkAndAnswersInTheirPixels) {
  constexpr int kTimes = 3;
  const cv::Mat image = blobs();
  cv::Mat large;
  cv::resize(image, large, {}, kTimes, kTimes, cv::INTER_NEAREST);  // whose areas are the image again
  for (const FeatureKind& kind : kinds()) {
    FeatureOptions options = options_for(kind);
    const Features expected = FeatureExtractor(options).extract(image);
    options.max_side_px = std::max(image.cols, image.rows);
    const Features found = FeatureExtractor(options).extract(large);
    ASSERT_EQ(found.keypoints.size(), expected.keypoints.size()) << to_string(kind);
    EXPECT_EQ(expected.pixel_size, 1.0);
    EXPECT_DOUBLE_EQ(found.pixel_size, kTimes);
    EXPECT_EQ(cv::norm(found.descriptors, expected.descriptors, cv::NORM_INF), 0) << to_string(kind);
    for (std::size_t i = 0; i < found.keypoints.size(); ++i) {
      const cv::KeyPoint& small = expected.keypoints[i];
      // The centre of pixel 0 is that of pixels 0 to 2: at 1.
      EXPECT_NEAR(found.keypoints[i].pt.x, kTimes * small.pt.x + 1, 1e-3);
      EXPECT_NEAR(found.keypoints[i].pt.y, kTimes * small.pt.y + 1, 1e-3);
      EXPECT_NEAR(found.keypoints[i].size, kTimes * small.size, 1e-3);
    }
  }
}

TEST(FeatureExtractor, BoundsWhatNoiseYields) {
  cv::Mat noise(200, 200, CV_8UC1);
  cv::RNG(2).fill(noise, cv::RNG::UNIFORM, 0, 256);
  for (const FeatureKind& kind : kinds()) {
    FeatureOptions options = options_for(kind, 77);
    options.detection_threshold = 0;
    EXPECT_LE(FeatureExtractor(options).extract(noise).keypoints.size(), 77u) << to_string(kind);
  }
}

TEST(FeatureExtractor, RootSiftIsOfUnitLength) {
  FeatureOptions options = options_for({});
  const Features root = FeatureExtractor(options).extract(blobs());
  for (int row = 0; row < root.descriptors.rows; ++row) EXPECT_NEAR(cv::norm(root.descriptors.row(row)), 1.0, 1e-5);
  options.root_sift = false;
  const Features plain = FeatureExtractor(options).extract(blobs());
  EXPECT_GT(cv::norm(plain.descriptors, cv::NORM_INF), 100.0);
  EXPECT_EQ(plain.keypoints.size(), root.keypoints.size());
}

TEST(FeatureExtractor, AFlatImageHasNoFeatures) {
  for (const int grey : {0, 90, 255}) {
    const cv::Mat flat(100, 120, CV_8UC1, cv::Scalar(grey));
    for (const FeatureKind& kind : kinds()) {
      for (const std::optional<double> threshold : {std::optional<double>(), std::optional(0.0)}) {
        if (threshold && (kind.detector == DetectorKind::Kaze || kind.detector == DetectorKind::Akaze))
          continue;  // all of it is a tie
        FeatureOptions options = options_for(kind);
        options.detection_threshold = threshold;
        const Features features = FeatureExtractor(options).extract(flat);
        EXPECT_TRUE(features.keypoints.empty()) << to_string(kind) << ' ' << grey;
        EXPECT_EQ(features.descriptors.rows, 0);
      }
    }
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
  options = {};
  options.star.suppression_px = 4;
  EXPECT_THAT(message(options), HasSubstr("star.suppression_px"));
  options = {};
  options.adaptive.emplace().min_features = 501;
  EXPECT_THAT(message(options), HasSubstr("adaptive.max_features"));
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
