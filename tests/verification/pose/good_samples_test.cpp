// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/good_samples.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace fabloop {
namespace {

constexpr std::size_t kNumData = 200;
constexpr double kPAccident = 0.02;

std::vector<std::size_t> first(std::size_t count) {
  std::vector<std::size_t> inliers(count);
  std::iota(inliers.begin(), inliers.end(), std::size_t{0});
  return inliers;
}

/// Every so many-th.
std::vector<std::size_t> spread(std::size_t step) {
  std::vector<std::size_t> inliers;
  for (std::size_t i = 0; i < kNumData; i += step) inliers.push_back(i);
  return inliers;
}

TEST(GoodSamples, CountsTheExactShareOfUniformDraws) {
  GoodSamples<5> good(kNumData);
  good.set_inliers(spread(2), kPAccident);
  for (int draw = 0; draw < 1000; ++draw) good.add_draw({kNumData, false});
  double share = 1;
  for (int i = 0; i < 5; ++i) share *= (100.0 - i) / (200.0 - i);
  EXPECT_NEAR(good.expected(), 1000 * share, 1e-9);
}

TEST(GoodSamples, CountsDrawsOfBeforeTheModelWasKnown) {
  GoodSamples<5> before(kNumData), after(kNumData);
  for (int draw = 0; draw < 10; ++draw) before.add_draw({40, false});
  for (int draw = 0; draw < 10; ++draw) before.add_draw({60, true});
  before.set_inliers(first(60), kPAccident);
  after.set_inliers(first(60), kPAccident);
  for (int draw = 0; draw < 10; ++draw) after.add_draw({40, false});
  for (int draw = 0; draw < 10; ++draw) after.add_draw({60, true});
  EXPECT_DOUBLE_EQ(before.expected(), after.expected());
  EXPECT_DOUBLE_EQ(after.expected(), 20);  // all of them inliers
}

TEST(GoodSamples, TheRichestDataAreTheFirstOnesWhereInliersComeFirst) {
  GoodSamples<5> good(kNumData);
  good.set_inliers(first(30), kPAccident);
  EXPECT_LE(good.richest(), 30);
  EXPECT_GE(good.richest(), 20);
}

TEST(GoodSamples, AFewInliersAmongTheFirstAreAnAccident) {
  GoodSamples<5> good(kNumData);
  std::vector<std::size_t> inliers = first(7);  // a sample and two that agree with it by luck,
  inliers.push_back(19);                        // and one where a prefix may end
  good.set_inliers(inliers, kPAccident);
  EXPECT_EQ(good.richest(), kNumData);
}

}  // namespace
}  // namespace fabloop
