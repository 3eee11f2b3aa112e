// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// P(chi-square with `kDegrees` degrees of freedom <= x).
template <int kDegrees>
double chi_square_cdf(double x) {
  static_assert(kDegrees >= 1 && kDegrees <= 3);
  if constexpr (kDegrees == 2) return -std::expm1(-0.5 * x);
  const double one_degree = std::erf(std::sqrt(0.5 * x));
  return kDegrees == 1 ? one_degree : one_degree - std::sqrt(2.0 * x / kPi) * std::exp(-0.5 * x);
}

/// Variance of Gaussian noise in `kDegrees` dimensions once errors beyond `max_error` are left out, as a share of the whole
/// variance: F_{k+2}(x) / F_k(x) with x = max_error^2 / variance and F the chi-square distribution. F_{k+2}(x) = F_k(x) -
/// (x/2)^{k/2} exp(-x/2) / Gamma(k/2 + 1).
template <int kDegrees>
double kept_variance_share(double variance, double max_error) {
  const double half_x = 0.5 * max_error * max_error / variance;
  const double lost = std::pow(half_x, 0.5 * kDegrees) * std::exp(-half_x) / std::tgamma(0.5 * kDegrees + 1.0);
  return 1.0 - lost / chi_square_cdf<kDegrees>(2.0 * half_x);
}

/// Noise of which only the errors up to a threshold were kept, and what that does to an estimate.
struct TruncatedNoise {
  double variance = 0;    ///< Per axis, of all of it.
  double kept_share = 1;  ///< kept_variance_share() at this variance.

  /// What the kept data's Hessian, of residuals in the noise's unit, is to be multiplied by to become the information of least
  /// squares over data that chose themselves by the threshold: kept_share / variance. (Huber 1964: psi(r) = r up to the
  /// threshold and 0 beyond has the variance E[psi^2] / E[psi']^2 = variance / F_{k+2}, and the kept data count F_k.)
  double information_scale() const { return kept_share / variance; }
};

/// From the scatter of the kept data, which is too small. A threshold within the noise says little about it: at most tripled.
template <int kDegrees>
TruncatedNoise noise_from_inliers(double variance_of_kept, double max_error, double min_variance) {
  constexpr int kIterations = 20;
  constexpr double kMinShare = 1.0 / 3.0;
  TruncatedNoise noise{std::max(variance_of_kept, min_variance), 1.0};
  for (int i = 0; i < kIterations; ++i) {
    noise.kept_share = std::max(kMinShare, kept_variance_share<kDegrees>(noise.variance, max_error));
    noise.variance = std::max(variance_of_kept, min_variance) / noise.kept_share;
  }
  return noise;
}

}  // namespace fabloop
