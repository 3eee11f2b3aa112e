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

TEST(SpatiallyEven, TheStrongestComeFirst) {
  const auto keypoints = crowded_on_the_left();
  const auto kept = spatially_even(keypoints, {1000, 1000}, 200);
  for (std::size_t k = 1; k < kept.size(); ++k) EXPECT_GE(keypoints[kept[k - 1]].response, keypoints[kept[k]].response);
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

}  // namespace
}  // namespace fabloop
