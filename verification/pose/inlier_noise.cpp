// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/inlier_noise.h"

#include <algorithm>
#include <cmath>

#include "frontend/geometry/pose.h"

namespace fabloop {
namespace {

constexpr double kMinSigmaRad = 1e-9;

/// The number of true ones, times how much more of those that stand near a pair in the order are true than of all: what its place
/// says before its residual does.
std::vector<double> num_true_by_order(const InlierNoise& noise) {
  constexpr double kReach = 0.1;               // of all, to either side
  constexpr std::size_t kLeastReach = 10;      // fewer tell no share
  constexpr double kPairsOfTheMeanShare = 10;  // count besides: shares of a few pairs differ by luck
  const std::size_t size = noise.p_true.size();
  const auto reach = std::max(kLeastReach, static_cast<std::size_t>(kReach * static_cast<double>(size)));
  std::vector<double> sums(size + 1, 0.0);
  for (std::size_t i = 0; i < size; ++i) sums[i + 1] = sums[i] + noise.p_true[i];
  const double mean = (noise.num_true + 0.5) / (static_cast<double>(size) + 1.0);
  std::vector<double> result(size);
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t first = i > reach ? i - reach : 0;
    const std::size_t end = std::min(size, i + reach + 1);
    // Its own residual has no part in it.
    const double num_true = sums[end] - sums[first] - noise.p_true[i];
    const double share = (num_true + kPairsOfTheMeanShare * mean) / (static_cast<double>(end - first - 1) + kPairsOfTheMeanShare);
    result[i] = noise.num_true * share / (1 - share) * (1 - mean) / mean;
  }
  return result;
}

}  // namespace

double normal_density(double value, double sigma) {
  const double z = value / sigma;
  return std::exp(-0.5 * z * z) / (sigma * std::sqrt(2.0 * kPi));
}

InlierNoise estimate_inlier_noise(std::span<const double> residuals_rad, double max_error_rad, std::size_t num_parameters) {
  InlierNoise noise;
  noise.p_true.resize(residuals_rad.size());
  double num_beyond = 0, sum_of_squares = 0;
  constexpr double kWidest = 3.0;
  for (std::size_t i = 0; i < residuals_rad.size(); ++i) {
    const double size = std::abs(residuals_rad[i]);
    noise.p_true[i] = size < max_error_rad ? 1.0 : 0.0;
    noise.num_true += noise.p_true[i];
    num_beyond += size >= max_error_rad && size < kWidest * max_error_rad;
    sum_of_squares += noise.p_true[i] * size * size;
  }
  noise.floor = num_beyond / (2.0 * (kWidest - 1.0) * max_error_rad);
  const auto parameters = static_cast<double>(num_parameters);
  constexpr int kRounds = 10;
  for (int round = 0;; ++round) {
    const double freedom = std::max(1.0, noise.num_true - parameters);
    noise.sigma_rad = std::max(kMinSigmaRad, std::sqrt(sum_of_squares / freedom));
    if (round == kRounds) return noise;
    const std::vector<double> num_true = num_true_by_order(noise);
    noise.num_true = sum_of_squares = 0;
    for (std::size_t i = 0; i < residuals_rad.size(); ++i) {
      if (noise.p_true[i] <= 0) continue;
      const double density = num_true[i] * normal_density(residuals_rad[i], noise.sigma_rad);
      noise.p_true[i] = density > 0 ? density / (density + noise.floor) : 0.0;
      noise.num_true += noise.p_true[i];
      sum_of_squares += noise.p_true[i] * residuals_rad[i] * residuals_rad[i];
    }
  }
}

double log_likelihood_over_floor(std::span<const double> residuals_rad, const InlierNoise& noise, double floor) {
  const std::vector<double> num_true = num_true_by_order(noise);
  double sum = 0;
  for (const double expected : num_true) sum -= expected / static_cast<double>(num_true.size());
  for (std::size_t i = 0; i < residuals_rad.size(); ++i) {
    if (noise.p_true[i] <= 0) continue;
    sum += std::log1p(num_true[i] * normal_density(residuals_rad[i], noise.sigma_rad) / floor);
  }
  return sum;
}

}  // namespace fabloop
