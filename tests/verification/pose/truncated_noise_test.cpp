// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/truncated_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace fabloop {
namespace {

constexpr double kSigma = 0.3;
constexpr int kNumSamples = 20000;
// 20,000 squared normals give their mean to 1 %, and undoing the truncation at 2.5 sigmas stretches that by 1.5; three of these.
constexpr double kSamplingError = 0.045;

/// Mean square per axis of `kDegrees`-dimensional noise no longer than `max_error`.
template <int kDegrees>
double scatter_of_kept(double max_error) {
  std::mt19937_64 random(kDegrees);
  std::normal_distribution<double> normal(0, kSigma);
  double sum = 0;
  int num_kept = 0;
  for (int i = 0; i < kNumSamples; ++i) {
    double squared_norm = 0;
    for (int axis = 0; axis < kDegrees; ++axis) squared_norm += std::pow(normal(random), 2);
    if (squared_norm > max_error * max_error) continue;
    sum += squared_norm;
    ++num_kept;
  }
  return sum / (kDegrees * num_kept);
}

template <int kDegrees>
void expect_variance_restored() {
  for (const double sigmas : {2.5, 3.0, 4.0, 8.0}) {
    const double kept = scatter_of_kept<kDegrees>(sigmas * kSigma);
    const TruncatedNoise noise = noise_from_inliers<kDegrees>(kept, sigmas * kSigma, 1e-14);
    EXPECT_NEAR(noise.variance / (kSigma * kSigma), 1, kSamplingError) << kDegrees << " axes, " << sigmas << " sigmas";
    EXPECT_NEAR(noise.kept_share * noise.variance, kept, 1e-9);
  }
}

TEST(TruncatedNoise, RestoresTheVarianceOfAllFromThatOfTheInliers) {
  expect_variance_restored<1>();
  expect_variance_restored<2>();
  expect_variance_restored<3>();
}

TEST(TruncatedNoise, IsLeftAloneByAFarThreshold) {
  EXPECT_NEAR(noise_from_inliers<2>(1, 10, 1e-14).information_scale(), 1, 1e-12);
  EXPECT_DOUBLE_EQ(noise_from_inliers<2>(0, 10, 1e-14).variance, 1e-14);
}

TEST(TruncatedNoise, ScalesTheInformationOfDataThatChoseThemselves) {
  // The location x with x = mean of the samples within the threshold of x: its variance against information_scale().
  constexpr int kTrials = 2000, kSamples = 60;
  constexpr double kThreshold = 2.5 * kSigma;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0, kSigma);
  double squared_error = 0, predicted = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> samples(kSamples);
    for (double& sample : samples) sample = normal(random);
    double location = 0;
    int num_kept = 0;
    for (int round = 0; round < 20; ++round) {
      double sum = 0;
      num_kept = 0;
      for (const double sample : samples) {
        if (std::abs(sample - location) > kThreshold) continue;
        sum += sample;
        ++num_kept;
      }
      location = sum / num_kept;
    }
    squared_error += location * location;
    const double variance = kSigma * kSigma;
    predicted += 1 / (num_kept * TruncatedNoise{variance, kept_variance_share<1>(variance, kThreshold)}.information_scale());
  }
  // 2000 squared errors give their mean to sqrt(2 / 2000) = 3 %; three of these.
  EXPECT_NEAR(squared_error / predicted, 1, 0.1);
}

}  // namespace
}  // namespace fabloop
