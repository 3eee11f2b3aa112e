// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/graduated.h"

#include <gtest/gtest.h>

#include "posegraph/robust_loss.h"

namespace fabloop {
namespace {

constexpr double kRounding = 1e-12;

TEST(GraduatedWeight, OfTruncatedLeastSquaresFallsFromOneToZeroWithoutJumps) {
  constexpr double kC2 = 4.0;
  for (const double mu : {0.01, 0.5, 3.0, 50.0}) {
    const double low = mu / (mu + 1.0) * kC2;
    const double high = (mu + 1.0) / mu * kC2;
    EXPECT_DOUBLE_EQ(graduated_weight(Surrogate::TruncatedLeastSquares, 0.99 * low, kC2, mu), 1.0);
    EXPECT_NEAR(graduated_weight(Surrogate::TruncatedLeastSquares, low * (1.0 + kRounding), kC2, mu), 1.0, 1e-9);
    EXPECT_NEAR(graduated_weight(Surrogate::TruncatedLeastSquares, high * (1.0 - kRounding), kC2, mu), 0.0, 1e-9);
    EXPECT_DOUBLE_EQ(graduated_weight(Surrogate::TruncatedLeastSquares, 1.01 * high, kC2, mu), 0.0);
    double before = 1.0;
    for (double chi2 = low; chi2 < high; chi2 += 0.01 * (high - low)) {
      const double weight = graduated_weight(Surrogate::TruncatedLeastSquares, chi2, kC2, mu);
      EXPECT_LE(weight, before);
      before = weight;
    }
  }
}

TEST(GraduatedWeight, EndsAsThatOfTheCostItself) {
  for (const double chi2 : {0.1, 3.9, 4.1, 100.0}) {
    EXPECT_EQ(graduated_weight(Surrogate::TruncatedLeastSquares, chi2, 4.0, std::numeric_limits<double>::infinity()),
              chi2 < 4.0 ? 1.0 : 0.0);
    EXPECT_DOUBLE_EQ(graduated_weight(Surrogate::GemanMcClure, chi2, 4.0, 1.0),
                     robust_weight(RobustLoss::GemanMcClure, chi2, 4.0));
  }
}

TEST(GraduatedWeight, IsTheSlopeOfAConvexCostAtTheFirstMu) {
  // With u = r^2 the cost rho has d rho / d u = weight; it is convex in r where weight + 2 u weight' >= 0.
  constexpr double kC2 = 4.0;
  constexpr double kMax = 1000.0;
  for (const Surrogate surrogate : {Surrogate::TruncatedLeastSquares, Surrogate::GemanMcClure}) {
    const double mu = convex_mu(surrogate, kMax, kC2);
    double before = 0.0;
    for (double r = 0.5; r < std::sqrt(kMax); r += 0.5) {
      const double slope = r * graduated_weight(surrogate, r * r, kC2, mu);
      // Truncated least squares: linear with slope -mu beyond the parabola, which Yang et al. call convex for small mu.
      EXPECT_GE(slope, before - mu * 0.5 - kRounding) << r;
      before = slope;
    }
  }
}

TEST(GraduatedWeight, HasNoTruncationWithinTheLargestErrorAtFirst) {
  for (const double ratio : {1.5, 10.0, 1e5}) {
    const double mu = convex_mu(Surrogate::TruncatedLeastSquares, 4.0 * ratio, 4.0);
    EXPECT_GT(graduated_weight(Surrogate::TruncatedLeastSquares, 4.0 * ratio, 4.0, mu), 0.0);
  }
}

}  // namespace
}  // namespace fabloop
