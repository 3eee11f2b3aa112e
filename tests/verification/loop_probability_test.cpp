// SPDX-License-Identifier: BSD-3-Clause
#include "verification/loop_probability.h"

#include <gtest/gtest.h>

namespace fabloop {
namespace {

TEST(LoopProbability, GrowsWithInliersAndWithAppearance) {
  EXPECT_LT(loop_probability({.log10_false_alarms = -2}), loop_probability({.log10_false_alarms = -8}));
  EXPECT_LT(loop_probability({.p_appearance = 0.1, .log10_false_alarms = -4}),
            loop_probability({.p_appearance = 0.9, .log10_false_alarms = -4}));
}

TEST(LoopProbability, ManyInliersOutweighAnUnlikelyAppearance) {
  EXPECT_GT(loop_probability({.p_appearance = 1e-6, .log10_false_alarms = -40}), 0.999);
}

TEST(LoopProbability, ThatAnotherPlaceTookThePosteriorSaysLittle) {
  const auto odds = [](double p) { return p / (1 - p); };
  const double undecided = odds(loop_probability({.p_appearance = 0.5, .log10_false_alarms = -6}));
  EXPECT_GT(odds(loop_probability({.p_appearance = 1e-12, .log10_false_alarms = -6})), undecided / 5);
}

TEST(LoopProbability, AnAccidentIsImprobable) { EXPECT_LT(loop_probability({.log10_false_alarms = 3}), 0.1); }

TEST(LoopProbability, AgreementWithOdometryNeverRaisesIt) {
  const double alone = loop_probability({.log10_false_alarms = -4});
  EXPECT_EQ(loop_probability({.log10_false_alarms = -4, .squared_distance = 0.0}), alone);
  EXPECT_EQ(loop_probability({.log10_false_alarms = -4, .squared_distance = 6.0}), alone);
}

TEST(LoopProbability, ContradictionOfOdometryLowersIt) {
  EXPECT_LT(loop_probability({.log10_false_alarms = -8, .squared_distance = 60.0}), 0.01);
}

TEST(LoopProbability, IsAProbabilityWhateverTheFigures) {
  for (const double appearance : {0.0, 1.0}) {
    for (const double alarms : {-1e6, 1e6}) {
      const double p = loop_probability({appearance, alarms, 1e9, 5});
      EXPECT_GE(p, 0.0);
      EXPECT_LE(p, 1.0);
    }
  }
}

}  // namespace
}  // namespace fabloop
