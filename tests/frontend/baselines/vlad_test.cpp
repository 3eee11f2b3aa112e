// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/baselines/vlad.h"

#include <gtest/gtest.h>

#include <cmath>

#include "frontend/error.h"

namespace fabloop {
namespace {

constexpr double kFloatRounding = 1e-6;

Vocabulary centres_at_0_and_10() { return {(cv::Mat_<float>(2, 2) << 0, 0, 10, 10)}; }

TEST(Vlad, TheVectorIsThatComputedByHand) {
  // To centre (0, 0): (1, 0) + (2, 4) = (3, 4), of length 5. To centre (10, 10): (0, -2), of length 2.
  const cv::Mat descriptors = (cv::Mat_<float>(3, 2) << 1, 0, 2, 4, 10, 8);
  const cv::Mat vlad = vlad_of(centres_at_0_and_10(), descriptors);
  ASSERT_EQ(vlad.rows, 1);
  ASSERT_EQ(vlad.cols, 4);
  // Each block has unit length, and there are two.
  const double half = std::sqrt(0.5);
  EXPECT_NEAR(vlad.at<float>(0), 0.6 * half, kFloatRounding);
  EXPECT_NEAR(vlad.at<float>(1), 0.8 * half, kFloatRounding);
  EXPECT_NEAR(vlad.at<float>(2), 0.0, kFloatRounding);
  EXPECT_NEAR(vlad.at<float>(3), -half, kFloatRounding);
}

TEST(Vlad, TheScoreIsTheCosineComputedByHand) {
  const Vocabulary centres = centres_at_0_and_10();
  const cv::Mat a = vlad_of(centres, (cv::Mat_<float>(2, 2) << 3, 4, 10, 8));  // (0.6, 0.8, 0, -1) / sqrt 2
  const cv::Mat b = vlad_of(centres, (cv::Mat_<float>(1, 2) << 4, 3));         // (0.8, 0.6, 0, 0)
  EXPECT_NEAR(vlad_score(a, b), 0.96 / std::sqrt(2.0), kFloatRounding);
  EXPECT_NEAR(vlad_score(a, a), 1.0, kFloatRounding);
}

TEST(Vlad, AnImageWithoutFeaturesIsLikeNothing) {
  const Vocabulary centres = centres_at_0_and_10();
  const cv::Mat none = vlad_of(centres, cv::Mat{});
  ASSERT_EQ(none.cols, 4);
  EXPECT_EQ(cv::norm(none), 0.0);
  EXPECT_EQ(vlad_score(none, vlad_of(centres, (cv::Mat_<float>(1, 2) << 1, 2))), 0.0);
}

TEST(Vlad, PackedBitsCountAsNumbers) {
  const Vocabulary centres{cv::Mat::zeros(1, 8, CV_32F)};
  const cv::Mat vlad = vlad_of(centres, (cv::Mat_<unsigned char>(1, 1) << 0b00000101));
  EXPECT_NEAR(vlad.at<float>(0), std::sqrt(0.5), kFloatRounding);
  EXPECT_NEAR(vlad.at<float>(2), std::sqrt(0.5), kFloatRounding);
  EXPECT_EQ(vlad.at<float>(1), 0.0F);
}

TEST(Vlad, DescriptorsOfAnotherLengthAreRefused) {
  EXPECT_THROW(vlad_of(centres_at_0_and_10(), cv::Mat::zeros(1, 3, CV_32F)), InputError);
}

TEST(Vlad, CentresAreMadeOfTheWords) {
  // Two clumps of words, and two centres wanted: their means.
  const Vocabulary words{(cv::Mat_<float>(4, 1) << 0, 2, 100, 104)};
  const Vocabulary centres = vlad_centres(words, {.num_centres = 2});
  ASSERT_EQ(centres.words.rows, 2);
  const auto [low, high] = std::minmax(centres.words.at<float>(0), centres.words.at<float>(1));
  EXPECT_EQ(low, 1.0F);
  EXPECT_EQ(high, 102.0F);
}

}  // namespace
}  // namespace fabloop
