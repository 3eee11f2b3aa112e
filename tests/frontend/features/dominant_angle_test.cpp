// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/dominant_angle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/frontend/features/textures.h"

namespace fabloop {
namespace {

double difference_deg(double a, double b) { return std::remainder(a - b, 360.0); }

TEST(DominantAngle, IsThatOfARamp) {
  for (const double angle_deg : {0.0, 37.0, 90.0, 200.0, 355.0}) {
    cv::Mat image(80, 80, CV_8UC1);
    for (int y = 0; y < 80; ++y) {
      for (int x = 0; x < 80; ++x) {
        const double along = (x - 40) * std::cos(angle_deg * CV_PI / 180) + (y - 40) * std::sin(angle_deg * CV_PI / 180);
        image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(128 + 2 * along);
      }
    }
    EXPECT_NEAR(difference_deg(dominant_angle(image, {40, 40}, 7.0F), angle_deg), 0.0, 5.0) << angle_deg;
  }
}

TEST(DominantAngle, TurnsWithTheImage) {
  const cv::Mat scene = testing_support::ground(121, 121, 40, 6);
  cv::Mat turned;
  cv::rotate(scene, turned, cv::ROTATE_90_CLOCKWISE);
  for (const float size : {4.0F, 7.0F, 15.0F}) {
    EXPECT_NEAR(difference_deg(dominant_angle(turned, {60, 60}, size), dominant_angle(scene, {60, 60}, size)), 90.0, 1.0);
  }
}

TEST(DominantAngle, OfAFlatImageIsZero) {
  const cv::Mat flat(20, 20, CV_8UC1, cv::Scalar(7));
  EXPECT_EQ(dominant_angle(flat, {10, 10}, 7.0F), 0.0F);
  EXPECT_EQ(dominant_angle(flat(cv::Rect(0, 0, 1, 1)), {0, 0}, 7.0F), 0.0F);
}

}  // namespace
}  // namespace fabloop
