// SPDX-License-Identifier: BSD-3-Clause
#include "verification/inlier_spread.h"

#include <gtest/gtest.h>

#include <random>

namespace fabloop {
namespace {

constexpr int kWidth = 640, kHeight = 480;

std::vector<cv::Point2f> random_points(std::uint64_t seed, int count, const cv::Rect2f& within) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> x(within.x, within.x + within.width), y(within.y, within.y + within.height);
  std::vector<cv::Point2f> points;
  for (int i = 0; i < count; ++i) points.emplace_back(x(random), y(random));
  return points;
}

TEST(ImageSpread, OfPointsAllOverFillsTheImage) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const ImageSpread spread =
        image_spread(random_points(seed, 2000, {0, 0, kWidth - 1, kHeight - 1}), {kWidth, kHeight}, {.hull_outliers = 0});
    EXPECT_GT(spread.hull_share, 0.95);
    EXPECT_LE(spread.hull_share, 1.0);
    EXPECT_EQ(spread.cell_share, 1.0);  // 31 points a cell
  }
}

TEST(ImageSpread, OfAQuarterIsAQuarter) {
  const auto points = random_points(1, 3000, {0, 0, kWidth / 2 - 1, kHeight / 2 - 1});
  const ImageSpread spread = image_spread(points, {kWidth, kHeight}, {.hull_outliers = 0});
  EXPECT_NEAR(spread.hull_share, 0.25, 0.01);
  EXPECT_EQ(spread.cell_share, 0.25);
}

TEST(ImageSpread, AFewAccidentsDoNotWidenTheHull) {
  auto points = random_points(1, 95, {100, 100, 60, 60});
  const double before = image_spread(points, {kWidth, kHeight}).hull_share;
  for (const cv::Point2f& corner : {cv::Point2f(0, 0), {639, 0}, {0, 479}, {639, 479}, {300, 470}}) points.push_back(corner);
  EXPECT_NEAR(image_spread(points, {kWidth, kHeight}).hull_share, before, 0.25 * before);
  EXPECT_GT(image_spread(points, {kWidth, kHeight}, {.hull_outliers = 0}).hull_share, 0.9);
}

TEST(ImageSpread, ALineHasNoAreaAndFewCells) {
  std::vector<cv::Point2f> points;
  for (int i = 0; i < 64; ++i) points.emplace_back(static_cast<float>(10 * i), 200.0F);
  const ImageSpread spread = image_spread(points, {kWidth, kHeight});
  EXPECT_EQ(spread.hull_share, 0.0);
  EXPECT_EQ(spread.cell_share, 8.0 / 64.0);
}

TEST(ImageSpread, HasAPlaceForEveryPoint) {
  // Refined keypoints may lie half a pixel outside of the outermost pixel centres, and a lens model beyond that.
  EXPECT_EQ(
      image_spread(std::vector<cv::Point2f>{{-0.5F, -0.5F}, {639.5F, 479.5F}, {-3.0F, 500.0F}}, {kWidth, kHeight}).cell_share,
      3.0 / 64.0);
  const ImageSpread none = image_spread({}, {kWidth, kHeight});
  EXPECT_EQ(none.hull_share, 0.0);
  EXPECT_EQ(none.cell_share, 0.0);
}

TEST(InlierSpread, LooksAtEachImageByItself) {
  View query, match;
  query.camera.width = 100, query.camera.height = 100;
  match.camera.width = 200, match.camera.height = 100;
  std::vector<Match> inliers;
  for (const cv::Point2f& corner : {cv::Point2f(0, 0), {99, 0}, {99, 99}, {0, 99}}) {
    const int index = static_cast<int>(inliers.size());
    query.features.keypoints.emplace_back(corner, 3.0F);
    match.features.keypoints.emplace_back(0.5F * corner, 3.0F);
    inliers.push_back({index, index, 0.5F});
  }
  const InlierSpread spread = inlier_spread(query, match, inliers);
  EXPECT_NEAR(spread.query.hull_share, 0.99 * 0.99, 1e-6);
  EXPECT_NEAR(spread.match.hull_share, 0.99 * 0.99 / 8.0, 1e-6);
  EXPECT_EQ(spread.query.cell_share, 4.0 / 64.0);
}

}  // namespace
}  // namespace fabloop
