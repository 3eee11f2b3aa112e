// SPDX-License-Identifier: BSD-3-Clause
#include "verification/chi_square.h"

#include <gtest/gtest.h>

namespace fabloop {
namespace {

TEST(ChiSquare, QuantilesAreThoseOfTheTables) {
  // Abramowitz & Stegun, table 26.8.
  EXPECT_NEAR(chi_square_quantile(0.95, 1), 3.841459, 1e-6);
  EXPECT_NEAR(chi_square_quantile(0.95, 2), 5.991465, 1e-6);
  EXPECT_NEAR(chi_square_quantile(0.95, 3), 7.814728, 1e-6);
  EXPECT_NEAR(chi_square_quantile(0.99, 5), 15.086272, 1e-6);
  EXPECT_NEAR(chi_square_quantile(0.99, 6), 16.811894, 1e-6);
}

}  // namespace
}  // namespace fabloop
