// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust_loss.h"

#include <gtest/gtest.h>

namespace fabloop {
namespace {

constexpr RobustLoss kLosses[] = {RobustLoss::None, RobustLoss::Huber, RobustLoss::Cauchy, RobustLoss::GemanMcClure,
                                  RobustLoss::DynamicCovarianceScaling};

TEST(RobustLoss, DerivativesAreThoseOfTheCost) {
  constexpr double kStep = 1e-5;
  constexpr double kScale2 = 4.0;
  for (const RobustLoss loss : kLosses) {
    for (const double s : {0.5, 3.0, 5.0, 50.0}) {
      const double slope = (robust_cost(loss, s + kStep, kScale2) - robust_cost(loss, s - kStep, kScale2)) / (2.0 * kStep);
      const double curvature =
          (robust_weight(loss, s + kStep, kScale2) - robust_weight(loss, s - kStep, kScale2)) / (2.0 * kStep);
      EXPECT_NEAR(robust_weight(loss, s, kScale2), slope, 1e-8);
      EXPECT_NEAR(robust_curvature(loss, s, kScale2), curvature, 1e-8);
    }
  }
}

TEST(RobustLoss, SmallErrorsAreSquaredAndLargeOnesCountLess) {
  for (const RobustLoss loss : kLosses) {
    EXPECT_NEAR(robust_cost(loss, 1e-6, 4.0), 1e-6, 1e-11);
    EXPECT_NEAR(robust_weight(loss, 0.0, 4.0), 1.0, 1e-12);
    EXPECT_LE(robust_weight(loss, 100.0, 4.0), 1.0);
  }
  EXPECT_LT(robust_cost(RobustLoss::GemanMcClure, 1e9, 4.0), 4.0);
  EXPECT_LT(robust_cost(RobustLoss::DynamicCovarianceScaling, 1e9, 4.0), 12.0);
}

}  // namespace
}  // namespace fabloop
