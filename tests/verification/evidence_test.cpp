// SPDX-License-Identifier: BSD-3-Clause
#include "verification/evidence.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fabloop {
namespace {

TEST(Evidence, EqualsTheFormulaByHand) {
  // 10 models a sample, 8 matches, 7 inliers, samples of 5, p = 0.01: 10 * 3 * C(8,7) * C(7,5) * 0.01^2 = 0.504
  EXPECT_NEAR(log10_false_alarms(8, 7, 5, 0.01, 10), std::log10(0.504), 1e-9);
}

TEST(Evidence, MoreInliersAreLessAccidental) {
  double previous = 10;
  for (std::size_t inliers = 20; inliers <= 100; ++inliers) {
    const double now = log10_false_alarms(100, inliers, 5, 0.012, 10);
    EXPECT_LT(now, previous);
    previous = now;
  }
}

TEST(Evidence, NoMoreInliersThanTheSampleProveNothing) { EXPECT_EQ(log10_false_alarms(50, 5, 5, 0.01, 10), 0.0); }

TEST(Evidence, AccidentsAreMoreLikelyInSmallImages) {
  const auto view = [](int width, int height) {
    View result;
    result.camera.width = width;
    result.camera.height = height;
    return result;
  };
  EXPECT_GT(p_accidental_epipolar_match(view(320, 240), 2), p_accidental_epipolar_match(view(640, 480), 2));
  EXPECT_EQ(p_accidental_epipolar_match(view(2, 2), 10), 1.0);
}

TEST(Evidence, AccidentsAreAsLikelyInAShrunkImageAsInASmallOne) {
  View small, shrunk;
  small.camera.width = 320;
  small.camera.height = 240;
  shrunk.camera.width = 960;
  shrunk.camera.height = 720;
  shrunk.features.pixel_size = 3.0;
  EXPECT_DOUBLE_EQ(p_accidental_epipolar_match(shrunk, 2), p_accidental_epipolar_match(small, 2));
}

}  // namespace
}  // namespace fabloop
