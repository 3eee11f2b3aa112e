// SPDX-License-Identifier: BSD-3-Clause
#include "verification/inlier_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
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

TEST(InlierNoise, ProbabilitiesAreCalibrated) {
  double claimed = 0, counted = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto data = residuals(300, 6000, 0.001, seed);
    const InlierNoise noise = estimate_inlier_noise(data.values, kGateRad, 0);
    for (std::size_t i = 0; i < data.values.size(); ++i) {
      if (noise.p_true[i] < 0.2 || noise.p_true[i] > 0.8) continue;
      claimed += noise.p_true[i];
      counted += data.is_true[i];
    }
  }
  EXPECT_GT(claimed, 100);
  EXPECT_NEAR(counted / claimed, 1.0, 0.1);
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

}  // namespace
}  // namespace fabloop
