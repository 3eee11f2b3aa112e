// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/spatially_even.h"

#include <gmock/gmock.h>

#include <random>
#include <set>

namespace fabloop {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

cv::KeyPoint keypoint(float x, float y, float response, float angle = 0) { return {x, y, 5.0F, angle, response}; }

/// 900 strong keypoints in the left tenth of the image, 100 weak ones over the rest.
std::vector<cv::KeyPoint> crowded_on_the_left() {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  std::vector<cv::KeyPoint> keypoints;
  for (int i = 0; i < 900; ++i) keypoints.push_back(keypoint(100 * unit(random), 1000 * unit(random), 10 + unit(random)));
  for (int i = 0; i < 100; ++i) keypoints.push_back(keypoint(100 + 900 * unit(random), 1000 * unit(random), unit(random)));
  return keypoints;
}

TEST(SpatiallyEven, AllAreKeptWhenFewerThanWanted) {
  const std::vector<cv::KeyPoint> keypoints{keypoint(1, 1, 0.1F), keypoint(2, 2, 0.3F), keypoint(3, 3, 0.2F)};
  EXPECT_THAT(spatially_even(keypoints, {10, 10}, 5), ElementsAre(1, 2, 0));
  EXPECT_THAT(spatially_even({}, {10, 10}, 5), IsEmpty());
  EXPECT_THAT(spatially_even(keypoints, {10, 10}, 0), IsEmpty());
}

TEST(SpatiallyEven, ARichCornerDoesNotStarveTheRest) {
  const auto keypoints = crowded_on_the_left();
  const auto kept = spatially_even(keypoints, {1000, 1000}, 200);
  EXPECT_EQ(kept.size(), 200u);
  // Beyond the cells that the crowd lies in, every keypoint is kept.
  const auto num_faint =
      std::count_if(keypoints.begin(), keypoints.end(), [](const auto& keypoint) { return keypoint.pt.x > 300; });
  const auto num_kept = std::count_if(kept.begin(), kept.end(), [&](std::size_t i) { return keypoints[i].pt.x > 300; });
  EXPECT_EQ(num_kept, num_faint);
  EXPECT_EQ(std::set<std::size_t>(kept.begin(), kept.end()).size(), kept.size());
}

TEST(SpatiallyEven, TheFirstCoverTheImageTooTheStrongestOfEachCellBeforeTheOthers) {
  const auto keypoints = crowded_on_the_left();
  const auto kept = spatially_even(keypoints, {1000, 1000}, 800);
  // 7 x 8 cells or so, one column of them in the crowd: the first turn takes one keypoint of each that has any.
  constexpr std::size_t kFirstTurn = 30;
  const auto in_crowd = [&](std::size_t i) { return keypoints[i].pt.x <= 100; };
  EXPECT_LT(std::count_if(kept.begin(), kept.begin() + kFirstTurn, in_crowd), 15);
  EXPECT_GT(std::count_if(kept.begin(), kept.end(), in_crowd), 600);
  const auto strongest =
      std::max_element(keypoints.begin(), keypoints.end(), [](const auto& a, const auto& b) { return a.response < b.response; });
  EXPECT_EQ(kept.front(), static_cast<std::size_t>(strongest - keypoints.begin()));
}

TEST(SpatiallyEven, EqualKeypointsGoByTheirIndex) {
  const std::vector<cv::KeyPoint> keypoints(6, keypoint(3, 3, 0.5F));
  EXPECT_THAT(spatially_even(keypoints, {10, 10}, 10), ElementsAre(0, 1, 2, 3, 4, 5));
}

TEST(SpatiallyEven, ASpotWithSeveralOrientationsStaysWholeAndTakesOneTurn) {
  // One cell: the strongest spot has two orientations; then two spots with one each, and one with two that no longer fits.
  const std::vector<cv::KeyPoint> keypoints{keypoint(1, 1, 0.2F),     keypoint(2, 2, 0.9F, 10), keypoint(2, 2, 0.9F, 80),
                                            keypoint(3, 3, 0.4F, 10), keypoint(3, 3, 0.4F, 50), keypoint(4, 4, 0.6F)};
  EXPECT_THAT(spatially_even(keypoints, {8, 8}, 4), ElementsAre(1, 2, 5, 0));
}

TEST(SpatiallyEven, KeypointsOutsideTheImageBelongToItsBorder) {
  std::vector<cv::KeyPoint> keypoints = crowded_on_the_left();
  keypoints.push_back(keypoint(-50, 2000, 5));
  EXPECT_EQ(spatially_even(keypoints, {1000, 1000}, 50).size(), 50u);
}

TEST(FirstFeatures, KeepKeypointsAndDescriptorsTogether) {
  Features features;
  features.descriptor_kind = DescriptorKind::Orb;
  features.pixel_size = 2.5;
  features.descriptors = cv::Mat(3, 32, CV_8U);
  for (int i = 0; i < 3; ++i) {
    features.keypoints.push_back(keypoint(static_cast<float>(i), 0, 1));
    features.descriptors.row(i) = cv::Scalar(i);
  }
  const Features two = first_features(features, 2);
  ASSERT_EQ(two.keypoints.size(), 2u);
  EXPECT_EQ(two.descriptor_kind, DescriptorKind::Orb);
  EXPECT_EQ(two.pixel_size, 2.5);
  ASSERT_EQ(two.descriptors.rows, 2);
  EXPECT_EQ(two.keypoints[1].pt.x, 1.0F);
  EXPECT_EQ(two.descriptors.at<std::uint8_t>(1, 31), 1);
  EXPECT_EQ(first_features(features, 9).keypoints.size(), 3u);
  EXPECT_EQ(first_features(features, 0).descriptors.rows, 0);
}

}  // namespace
}  // namespace fabloop
