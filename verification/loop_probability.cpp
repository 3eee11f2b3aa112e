// SPDX-License-Identifier: BSD-3-Clause
#include "verification/loop_probability.h"

#include <algorithm>
#include <cmath>

#include "verification/pose/pose_choice.h"

namespace fabloop {
namespace {

// Logistic regression of "right place and right pose" on -log10 of the number of false alarms.
constexpr double kOffset = -1.0;
constexpr double kPerDecade = 0.52;
/// More decades than so many were not seen to be wrong, nor could they be counted.
constexpr double kMaxDecades = 30.0;
/// A posterior over places is sharper than it is right (words are not independent). And it is shared: where several places show
/// the same ground, one takes nearly all, and of those left with under a tenth, 46 % (seneca) to 94 % (sheffield_cross) are
/// right.
constexpr double kMinAppearance = 0.2;
constexpr double kMaxAppearance = 0.98;

}  // namespace

double loop_probability(const LoopEvidence& evidence) {
  const double p = std::clamp(evidence.p_appearance, kMinAppearance, kMaxAppearance);
  double log_odds = std::log(p / (1.0 - p)) + kOffset + kPerDecade * std::min(kMaxDecades, -evidence.log10_false_alarms);
  if (evidence.squared_distance) {
    const double beyond = std::max(0.0, *evidence.squared_distance - evidence.degrees_of_freedom);
    log_odds += prior_log_likelihood(beyond, evidence.degrees_of_freedom);
  }
  return 1.0 / (1.0 + std::exp(-log_odds));
}

}  // namespace fabloop
