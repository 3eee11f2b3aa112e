// SPDX-License-Identifier: BSD-3-Clause
#include "verification/matching/similar_group.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

namespace fabloop {
namespace {

constexpr double kSize = 800;

struct SimilarPair {
  Features query, match;
  std::vector<Match> matches;
};

/// Matches i to i: the first `num_true` follow one similarity but for some noise, the others nothing.
SimilarPair make_similar_pair(std::uint64_t seed, int num_true, int num_false, double turn_deg, double log2_growth) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(0, kSize), angle(0, 360), octaves(-2, 2);
  std::normal_distribution<double> normal(0, 1);
  const std::complex<double> centre(kSize / 2, kSize / 2);
  const auto similarity = std::polar(std::exp2(log2_growth), turn_deg * std::numbers::pi / 180);
  SimilarPair pair;
  for (int i = 0; i < num_true + num_false; ++i) {
    const std::complex<double> from(place(random), place(random));
    std::complex<double> to(place(random), place(random));
    const double from_deg = angle(random);
    double to_deg = angle(random), growth = octaves(random);
    if (i < num_true) {
      to = centre + similarity * (from - centre) + std::complex<double>(5 * normal(random), 5 * normal(random));
      to_deg = from_deg + turn_deg + 8 * normal(random);
      growth = log2_growth + 0.1 * normal(random);
    }
    pair.query.keypoints.emplace_back(static_cast<float>(from.real()), static_cast<float>(from.imag()), 8.0F,
                                      static_cast<float>(from_deg));
    pair.match.keypoints.emplace_back(static_cast<float>(to.real()), static_cast<float>(to.imag()),
                                      static_cast<float>(8 * std::exp2(growth)),
                                      static_cast<float>(std::fmod(to_deg + 720, 360)));
    pair.matches.push_back({i, i, 0.5F});
  }
  std::shuffle(pair.matches.begin(), pair.matches.end(), random);
  return pair;
}

TEST(SimilarGroup, FindsAFewTrueMatchesAmongManyFalse) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const SimilarPair pair =
        make_similar_pair(seed, 6, 30, 3.6 * static_cast<double>(seed), 0.01 * static_cast<double>(seed) - 0.5);
    found += largest_similar_group(pair.query, pair.match, pair.matches) >= 5;
  }
  EXPECT_GE(found, 97);  // one in six may be off by the noise of the two that tell the similarity
}

TEST(SimilarGroup, IsSmallAmongFalseMatches) {
  int four = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const SimilarPair pair = make_similar_pair(seed, 0, 36, 0, 0);
    four += largest_similar_group(pair.query, pair.match, pair.matches) >= 4;
  }
  EXPECT_LE(four, 20);  // one false pair in ten is looked at again
}

TEST(SimilarGroup, StopsAtEnough) {
  const SimilarPair pair = make_similar_pair(1, 50, 0, 30, 0);
  const std::size_t all = largest_similar_group(pair.query, pair.match, pair.matches, {.enough = 1000});
  EXPECT_GE(all, 40u);
  const std::size_t enough = largest_similar_group(pair.query, pair.match, pair.matches, {.enough = 10});
  EXPECT_GE(enough, 10u);
  EXPECT_LE(enough, all);
}

TEST(SimilarGroup, CountsMatchesWithoutAnglesByPlaceAndSize) {
  SimilarPair pair = make_similar_pair(2, 12, 0, 90, 0.5);
  for (cv::KeyPoint& keypoint : pair.query.keypoints) keypoint.angle = -1;
  EXPECT_GE(largest_similar_group(pair.query, pair.match, pair.matches), 10u);
}

TEST(SimilarGroup, NeedsTwoMatchesToCompare) {
  const SimilarPair pair = make_similar_pair(3, 2, 0, 0, 0);
  EXPECT_EQ(largest_similar_group(pair.query, pair.match, {}), 0u);
  EXPECT_EQ(largest_similar_group(pair.query, pair.match, {pair.matches[0]}), 1u);
}

}  // namespace
}  // namespace fabloop
