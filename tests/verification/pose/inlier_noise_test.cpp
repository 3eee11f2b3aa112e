// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/inlier_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace fabloop {
namespace {

constexpr double kGateRad = 0.004;

struct Residuals {
  std::vector<double> values;
  std::vector<bool> is_true;
};

Residuals residuals(int num_true, int num_accidental, double sigma_rad, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, sigma_rad);
  std::uniform_real_distribution<double> anywhere(-0.3, 0.3);
  Residuals result;
  for (int i = 0; i < num_true; ++i) result.values.push_back(normal(random));
  for (int i = 0; i < num_accidental; ++i) result.values.push_back(anywhere(random));
  for (int i = 0; i < num_true + num_accidental; ++i) result.is_true.push_back(i < num_true);
  return result;
}

TEST(InlierNoise, TellsTheNoiseOfTheTrueOnes) {
  for (const double sigma_rad : {0.0003, 0.001}) {
    const auto data = residuals(2000, 4000, sigma_rad, 1);
    const InlierNoise noise = estimate_inlier_noise(data.values, kGateRad, 0);
    EXPECT_NEAR(noise.sigma_rad, sigma_rad, 0.05 * sigma_rad);  // three standard errors of 2000
    EXPECT_NEAR(noise.num_true, 2000, 40);
  }
}

/// Sorted by a score that is better for true ones by `gap` of its standard deviations: 0 for an order that says nothing.
Residuals sorted_by_score(const Residuals& data, double gap, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<std::pair<double, std::size_t>> scores;
  for (std::size_t i = 0; i < data.values.size(); ++i) scores.emplace_back(normal(random) + (data.is_true[i] ? 0 : gap), i);
  std::sort(scores.begin(), scores.end());
  Residuals sorted;
  for (const auto& [score, i] : scores) {
    sorted.values.push_back(data.values[i]);
    sorted.is_true.push_back(data.is_true[i]);
  }
  return sorted;
}

TEST(InlierNoise, ProbabilitiesAreCalibratedWhateverTheOrderSays) {
  for (const double gap : {0.0, 2.0}) {
    double claimed = 0, counted = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const auto data = sorted_by_score(residuals(300, 6000, 0.001, seed), gap, seed);
      const InlierNoise noise = estimate_inlier_noise(data.values, kGateRad, 0);
      for (std::size_t i = 0; i < data.values.size(); ++i) {
        if (noise.p_true[i] < 0.2 || noise.p_true[i] > 0.8) continue;
        claimed += noise.p_true[i];
        counted += data.is_true[i];
      }
    }
    EXPECT_GT(claimed, 100) << gap;
    EXPECT_NEAR(counted / claimed, 1.0, 0.1) << gap;
  }
}

TEST(InlierNoise, WithoutOutliersAllAreTrue) {
  const auto data = residuals(100, 0, 0.001, 3);
  const InlierNoise noise = estimate_inlier_noise(data.values, kGateRad, 0);
  EXPECT_NEAR(noise.num_true, 100, 1e-9);
}

TEST(InlierNoise, ParametersCostFreedom) {
  const auto data = residuals(20, 0, 0.001, 4);
  const double free = estimate_inlier_noise(data.values, kGateRad, 0).sigma_rad;
  EXPECT_NEAR(estimate_inlier_noise(data.values, kGateRad, 5).sigma_rad, free * std::sqrt(20.0 / 15.0), 1e-12);
}

TEST(InlierNoise, OfNothingIsNothing) { EXPECT_EQ(estimate_inlier_noise({}, kGateRad, 5).num_true, 0); }

TEST(InlierNoise, APairAmongTrueOnesIsLikelierTrue) {
  auto data = residuals(60, 2000, 0.001, 5);  // the true ones come first
  data.values[30] = data.values[1500] = 0.002;
  const InlierNoise noise = estimate_inlier_noise(data.values, kGateRad, 0);
  EXPECT_GT(noise.p_true[30], 0.5);
  EXPECT_LT(noise.p_true[1500], 0.3);
}

TEST(InlierNoise, LikelihoodPrefersMorePairsToAFewThatLieCloser) {
  // Of 25 true pairs with a noise of a third of the threshold, another model has half, bent to lie closer.
  auto more = residuals(25, 0, kGateRad / 3, 7).values;
  auto closer = residuals(12, 0, kGateRad / 12, 8).values;
  const auto accidental = residuals(0, 175, 1, 9).values;
  closer.resize(25, 0.1);
  for (auto* values : {&more, &closer}) values->insert(values->end(), accidental.begin(), accidental.end());
  const InlierNoise of_more = estimate_inlier_noise(more, kGateRad, 5);
  const InlierNoise of_closer = estimate_inlier_noise(closer, kGateRad, 5);
  const double floor = 1.0 / kGateRad;
  EXPECT_GT(of_closer.num_true * std::log(kGateRad / of_closer.sigma_rad),
            of_more.num_true * std::log(kGateRad / of_more.sigma_rad));
  EXPECT_GT(log_likelihood_over_floor(more, of_more, floor), log_likelihood_over_floor(closer, of_closer, floor));
}

TEST(InlierNoise, LikelihoodPrefersTheSharperOfTwoModelsWithAsManyPairs) {
  const auto wide = residuals(40, 0, 0.0015, 11).values;
  auto sharp = wide;
  for (double& value : sharp) value *= 0.5;
  const InlierNoise of_wide = estimate_inlier_noise(wide, kGateRad, 5);
  const InlierNoise of_sharp = estimate_inlier_noise(sharp, kGateRad, 5);
  const double floor = 1.0 / kGateRad;
  EXPECT_GT(log_likelihood_over_floor(sharp, of_sharp, floor), log_likelihood_over_floor(wide, of_wide, floor));
}

}  // namespace
}  // namespace fabloop
