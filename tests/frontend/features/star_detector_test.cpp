// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/star_detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/frontend/features/textures.h"

namespace fabloop {
namespace {

constexpr double kThreshold = 10.0;

cv::Mat with_disc(cv::Point2d centre, double radius, int disc, int background) {
  constexpr int kBits = 4;
  cv::Mat image(200, 220, CV_8UC1, cv::Scalar(background));
  const cv::Point fixed(cvRound(centre.x * (1 << kBits)), cvRound(centre.y * (1 << kBits)));
  cv::circle(image, fixed, cvRound(radius * (1 << kBits)), cv::Scalar(disc), cv::FILLED, cv::LINE_AA, kBits);
  return image;
}

/// Keypoints as a set: sorted by place and size.
std::vector<cv::KeyPoint> sorted(std::vector<cv::KeyPoint> keypoints) {
  std::sort(keypoints.begin(), keypoints.end(), [](const cv::KeyPoint& a, const cv::KeyPoint& b) {
    return std::tie(a.pt.y, a.pt.x, a.size) < std::tie(b.pt.y, b.pt.x, b.size);
  });
  return keypoints;
}

/// Share of keypoints that have one of the others at the same place, of the same size.
double share_in(const std::vector<cv::KeyPoint>& keypoints, const std::vector<cv::KeyPoint>& others) {
  const auto found = std::count_if(keypoints.begin(), keypoints.end(), [&](const cv::KeyPoint& a) {
    return std::any_of(others.begin(), others.end(), [&](const cv::KeyPoint& b) {
      return std::hypot(a.pt.x - b.pt.x, a.pt.y - b.pt.y) < 1e-3 && std::abs(a.size - b.size) < 1e-3;
    });
  });
  return static_cast<double>(found) / static_cast<double>(keypoints.size());
}

TEST(StarDetector, FindsADiscAtItsCentreWithItsSize) {
  for (const double radius : {3.0, 4.5, 6.0, 9.0, 12.0}) {
    for (const int disc : {200, 20}) {
      const cv::Point2d centre(103.3, 96.7);
      auto keypoints = detect_star(with_disc(centre, radius, disc, 100), {}, kThreshold);
      ASSERT_FALSE(keypoints.empty()) << radius;
      const auto strongest = *std::max_element(keypoints.begin(), keypoints.end(),
                                               [](const auto& a, const auto& b) { return a.response < b.response; });
      EXPECT_NEAR(strongest.pt.x, centre.x, 0.5) << radius;
      EXPECT_NEAR(strongest.pt.y, centre.y, 0.5) << radius;
      EXPECT_NEAR(strongest.size / (2.0 * radius + 1.0), 1.0, 0.2) << radius;
      EXPECT_GT(strongest.response, 0.7 * std::abs(disc - 100)) << radius;
    }
  }
}

TEST(StarDetector, LeavesLinesAndEdgesAlone) {
  for (const double angle_deg : {0.0, 30.0, 45.0, 80.0}) {
    cv::Mat line(200, 220, CV_8UC1, cv::Scalar(80)), edge = line.clone();
    const cv::Point2d direction(400 * std::cos(angle_deg * CV_PI / 180), 400 * std::sin(angle_deg * CV_PI / 180));
    const cv::Point2d centre(110, 100), normal(-direction.y, direction.x);
    cv::line(line, centre - direction, centre + direction, cv::Scalar(220), 5, cv::LINE_AA);
    const std::vector<cv::Point> half = {centre - direction, centre + direction, centre + direction + normal,
                                         centre - direction + normal};
    cv::fillConvexPoly(edge, half, cv::Scalar(220), cv::LINE_AA);
    EXPECT_TRUE(detect_star(line, {}, 2.0).empty()) << angle_deg;
    EXPECT_TRUE(detect_star(edge, {}, 2.0).empty()) << angle_deg;
  }
}

TEST(StarDetector, KeepsLinesWhenToldTo) {
  cv::Mat line(200, 220, CV_8UC1, cv::Scalar(80));
  cv::line(line, {20, 40}, {200, 150}, cv::Scalar(220), 5, cv::LINE_AA);
  StarOptions lenient;
  lenient.line_threshold = lenient.line_threshold_scale = 1e6;
  EXPECT_FALSE(detect_star(line, lenient, 2.0).empty());
}

TEST(StarDetector, MovesWithTheImage) {
  const cv::Mat scene = testing_support::ground(260, 220, 40, 3);
  const cv::Rect here(10, 12, 230, 190), there(17, 15, 230, 190);
  const auto keypoints = detect_star(scene(here).clone(), {}, kThreshold);
  auto moved = detect_star(scene(there).clone(), {}, kThreshold);
  ASSERT_GT(keypoints.size(), 50u);
  for (cv::KeyPoint& keypoint : moved) keypoint.pt += cv::Point2f(there.tl() - here.tl());
  std::vector<cv::KeyPoint> inner;  // those that neither border cuts
  const int border = StarOptions{}.max_size_px / 2 + 10;
  const cv::Rect2f both(static_cast<float>(border), static_cast<float>(border), static_cast<float>(here.width - 2 * border),
                        static_cast<float>(here.height - 2 * border));
  std::copy_if(keypoints.begin(), keypoints.end(), std::back_inserter(inner), [&](const auto& k) { return both.contains(k.pt); });
  ASSERT_GT(inner.size(), 20u);
  EXPECT_EQ(share_in(inner, moved), 1.0);
}

TEST(StarDetector, TurnsWithTheImage) {
  const cv::Mat scene = testing_support::ground(230, 190, 40, 4);
  cv::Mat turned;
  cv::rotate(scene, turned, cv::ROTATE_90_CLOCKWISE);
  const auto keypoints = detect_star(scene, {}, kThreshold);
  auto back = detect_star(turned, {}, kThreshold);
  for (cv::KeyPoint& keypoint : back) {
    keypoint.pt = {keypoint.pt.y, static_cast<float>(turned.cols - 1) - keypoint.pt.x};
  }
  ASSERT_GT(keypoints.size(), 50u);
  EXPECT_EQ(keypoints.size(), back.size());
  EXPECT_GE(share_in(keypoints, back), 0.99);  // but for ties, which go to the first
}

TEST(StarDetector, DoesNotCareForTheSignOfContrast) {
  const cv::Mat scene = testing_support::ground(230, 190, 40, 5);
  const auto keypoints = sorted(detect_star(scene, {}, kThreshold));
  const auto inverted = sorted(detect_star(255 - scene, {}, kThreshold));
  ASSERT_GT(keypoints.size(), 50u);
  ASSERT_EQ(keypoints.size(), inverted.size());
  EXPECT_EQ(share_in(keypoints, inverted), 1.0);
}

TEST(StarDetector, FindsTheSameLargeBlobInAnEnlargedImage) {
  const auto largest_response = [](const cv::Mat& image) {
    const auto keypoints = detect_star(image, {}, kThreshold);
    return *std::max_element(keypoints.begin(), keypoints.end(),
                             [](const auto& a, const auto& b) { return a.response < b.response; });
  };
  const float size = largest_response(with_disc({100, 100}, 4, 200, 60)).size;
  EXPECT_NEAR(largest_response(with_disc({100, 100}, 12, 200, 60)).size / size, 25.0 / 9.0, 0.4);
}

}  // namespace
}  // namespace fabloop
