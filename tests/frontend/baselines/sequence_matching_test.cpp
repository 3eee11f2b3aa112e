// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/baselines/sequence_matching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "frontend/error.h"

namespace fabloop {
namespace {

/// Differences of queries and places that have nothing in common, with a little less along a line: query 20 + k shows place
/// 40 + `speed` k.
DifferenceRows planted(double speed, std::size_t num_queries = 40, std::size_t num_places = 120) {
  std::mt19937 random(5);
  DifferenceRows rows(num_queries, std::vector<float>(num_places));
  for (auto& row : rows) {
    for (float& difference : row) difference = 10.0F + static_cast<float>(random() % 1000) / 500.0F;
  }
  for (std::size_t k = 0; k < 16; ++k) {
    rows[20 + k][40 + static_cast<std::size_t>(std::llround(speed * static_cast<double>(k)))] -= 1.5F;
  }
  return rows;
}

std::size_t best_place(const std::vector<double>& row) {
  return static_cast<std::size_t>(std::max_element(row.begin(), row.end()) - row.begin());
}

TEST(SequenceMatching, FindsAPlantedSequenceAtEverySpeedItTries) {
  for (const double speed : {0.8, 0.9, 1.0, 1.1, 1.2}) {
    const auto scores = sequence_scores(planted(speed));
    // From the tenth image of the revisit on, the whole sequence lies on it.
    for (std::size_t k = 9; k < 16; ++k) {
      const auto place = 40 + std::llround(speed * static_cast<double>(k));
      EXPECT_LE(std::abs(static_cast<long long>(best_place(scores[20 + k])) - place), 1) << speed << ", image " << k;
    }
  }
}

TEST(SequenceMatching, OneImageAloneWouldNotDo) {
  const auto alone = sequence_scores(planted(1.0), {.length = 1});
  std::size_t num_wrong = 0;
  for (std::size_t k = 9; k < 16; ++k) num_wrong += best_place(alone[20 + k]) != 40 + k;
  EXPECT_GT(num_wrong, 0u) << "the sequence is too easy to tell";
}

TEST(SequenceMatching, AScoreIsTheMeanContrastAlongTheLine) {
  // One place is 4 apart, five are 10: mean 9, variance 25 - 20 = 5, so it stands out by -5 / sqrt 5.
  const DifferenceRows rows(2, {10, 10, 4, 10, 10, 10});
  const auto scores = sequence_scores(rows, {.contrast_window = 12, .length = 1});
  EXPECT_NEAR(scores[0][2], std::sqrt(5.0), 1e-6);
  EXPECT_NEAR(scores[0][0], -1.0 / std::sqrt(5.0), 1e-6);
  // Two images at one place an image: the mean of (1, 1) and (0, 0), ...
  const auto of_two = sequence_scores(rows, {.contrast_window = 12, .length = 2, .min_speed = 1, .max_speed = 1});
  EXPECT_NEAR(of_two[1][2], 0.5 * (std::sqrt(5.0) - 1.0 / std::sqrt(5.0)), 1e-6);
}

TEST(SequenceMatching, WhereNoLineFitsNothingIsFound) {
  const auto scores = sequence_scores(planted(1.0));
  for (std::size_t query = 0; query < 9; ++query) {
    for (const double score : scores[query]) EXPECT_TRUE(std::isinf(score)) << query;
  }
  // The slowest line reaches back 0.8 * 9 places.
  EXPECT_TRUE(std::isinf(scores[20][6]));
  EXPECT_TRUE(std::isfinite(scores[20][7]));
}

TEST(SequenceMatching, PatchesAreNormalised) {
  cv::Mat gray(64, 128, CV_8UC1);
  cv::RNG random(1);
  random.fill(gray, cv::RNG::UNIFORM, 50, 100);
  const cv::Mat1f small = small_image(gray);
  ASSERT_EQ(small.size(), cv::Size(64, 32));
  cv::Scalar mean, deviation;
  cv::meanStdDev(small(cv::Rect(8, 16, 8, 8)), mean, deviation);
  EXPECT_NEAR(mean[0], 0.0, 1e-5);
  EXPECT_NEAR(deviation[0], 1.0, 1e-5);
  // Brightness and contrast do not matter, up to rounding to grey levels.
  cv::Mat brighter;
  gray.convertTo(brighter, -1, 2.0, 30.0);
  EXPECT_LT(cv::norm(small, small_image(brighter), cv::NORM_INF), 0.2);
  EXPECT_EQ(cv::norm(small_image(cv::Mat::ones(64, 128, CV_8UC1))), 0.0) << "one grey";
}

TEST(SequenceMatching, BadOptionsAreRefused) {
  EXPECT_THROW(small_image(cv::Mat::zeros(64, 128, CV_8UC1), {.width_px = 60}), InputError);
  EXPECT_THROW(sequence_scores(planted(1.0), {.length = 0}), InputError);
  EXPECT_THROW(sequence_scores(planted(1.0), {.min_speed = 2.0}), InputError);
}

}  // namespace
}  // namespace fabloop
