// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/octagon_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace fabloop {
namespace {

bool is_inside(const Octagon& octagon, int dx, int dy) {
  return std::abs(dx) <= octagon.radius && std::abs(dy) <= octagon.radius &&
         std::abs(dx) + std::abs(dy) <= 2 * octagon.radius - octagon.cut;
}

TEST(OctagonSums, AreThoseOfThePixelsWhereverTheOctagonFits) {
  cv::Mat image(41, 47, CV_8UC1);
  cv::RNG(5).fill(image, cv::RNG::UNIFORM, 0, 256);
  const OctagonSums sums(image);
  for (const int radius : {1, 2, 3, 4, 6, 8, 12, 16, 20}) {
    const Octagon octagon(radius);
    for (int y = radius; y < image.rows - radius; ++y) {
      for (int x = radius; x < image.cols - radius; ++x) {
        std::uint32_t expected = 0;
        int num_pixels = 0;
        for (int dy = -radius; dy <= radius; ++dy) {
          for (int dx = -radius; dx <= radius; ++dx) {
            if (!is_inside(octagon, dx, dy)) continue;
            expected += image.at<std::uint8_t>(y + dy, x + dx);
            ++num_pixels;
          }
        }
        ASSERT_EQ(num_pixels, octagon.num_pixels);
        ASSERT_EQ(sums.sum(octagon, x, y), expected) << radius << " at " << x << ',' << y;
      }
    }
  }
}

TEST(OctagonSums, AreOfOctagonsThatAreNearlyRegular) {
  for (const int radius : {4, 8, 16, 64}) {
    const Octagon octagon(radius);
    // Half a pixel at both ends belongs to a side.
    const double straight_side = 2.0 * (radius - octagon.cut) + 1.0, slanted_side = std::sqrt(2.0) * (octagon.cut + 1.0);
    EXPECT_NEAR(straight_side / slanted_side, 1.0, 2.0 / radius) << radius;
  }
}

}  // namespace
}  // namespace fabloop
