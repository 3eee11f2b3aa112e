// SPDX-License-Identifier: BSD-3-Clause
#include "verification/inlier_noise.h"

#include <algorithm>
#include <cmath>

#include "frontend/geometry/pose.h"

namespace fabloop {
namespace {

constexpr double kMinSigmaRad = 1e-9;

double normal_density(double value, double sigma) {
  const double z = value / sigma;
  return std::exp(-0.5 * z * z) / (sigma * std::sqrt(2.0 * kPi));
}

}  // namespace

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
  const double floor = num_beyond / (2.0 * (kWidest - 1.0) * max_error_rad);
  const auto parameters = static_cast<double>(num_parameters);
  constexpr int kRounds = 10;
  for (int round = 0;; ++round) {
    const double freedom = std::max(1.0, noise.num_true - parameters);
    noise.sigma_rad = std::max(kMinSigmaRad, std::sqrt(sum_of_squares / freedom));
    if (round == kRounds) return noise;
    const double num_true = noise.num_true;
    noise.num_true = sum_of_squares = 0;
    for (std::size_t i = 0; i < residuals_rad.size(); ++i) {
      if (noise.p_true[i] <= 0) continue;
      const double density = num_true * normal_density(residuals_rad[i], noise.sigma_rad);
      noise.p_true[i] = density / (density + floor);
      noise.num_true += noise.p_true[i];
      sum_of_squares += noise.p_true[i] * residuals_rad[i] * residuals_rad[i];
    }
  }
}

}  // namespace fabloop
