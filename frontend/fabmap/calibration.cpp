// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/calibration.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "frontend/error.h"

namespace fabloop {

Calibration calibration(const std::vector<Decision>& decisions, std::size_t num_bins) {
  if (num_bins == 0) throw InputError("a reliability diagram needs at least one bin");
  Calibration result;
  result.num_decisions = decisions.size();
  const auto count = static_cast<double>(num_bins);
  for (std::size_t i = 0; i < num_bins; ++i) {
    result.bins.push_back({static_cast<double>(i) / count, static_cast<double>(i + 1) / count});
  }
  for (const Decision& decision : decisions) {
    if (!(decision.score >= 0.0 && decision.score <= 1.0)) {
      throw InputError("a score of " + std::to_string(decision.score) + " is no probability");
    }
    const auto index = std::min(num_bins - 1, static_cast<std::size_t>(decision.score * count));
    ReliabilityBin& bin = result.bins[index];
    ++bin.count;
    bin.mean_score += decision.score;
    bin.share_true += decision.is_true;
    const double error = decision.score - (decision.is_true ? 1.0 : 0.0);
    result.brier_score += error * error;
  }
  if (decisions.empty()) return result;
  const auto num_decisions = static_cast<double>(decisions.size());
  result.brier_score /= num_decisions;
  for (ReliabilityBin& bin : result.bins) {
    if (bin.count == 0) continue;
    result.expected_calibration_error += std::abs(bin.mean_score - bin.share_true) / num_decisions;
    bin.mean_score /= static_cast<double>(bin.count);
    bin.share_true /= static_cast<double>(bin.count);
  }
  return result;
}

}  // namespace fabloop
