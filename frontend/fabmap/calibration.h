// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "frontend/fabmap/precision_recall.h"

namespace fabloop {

/// The decisions whose score lies in [lowest, highest), the last bin's end included.
struct ReliabilityBin {
  double lowest = 0.0, highest = 1.0;
  std::size_t count = 0;
  double mean_score = 0.0;  ///< What was claimed; 0 in an empty bin.
  double share_true = 0.0;  ///< What was so; 0 in an empty bin.
};

/// How far probabilities may be taken at their word.
struct Calibration {
  std::size_t num_decisions = 0;
  std::vector<ReliabilityBin> bins;         ///< Of equal width over [0, 1]: the reliability diagram.
  double expected_calibration_error = 0.0;  ///< Mean of |claimed - so| over the bins by their counts (Naeini et al., AAAI 2015).
  double brier_score = 0.0;                 ///< Mean squared difference of score and truth (Brier 1950): 0 is perfect.
};

/// Compares scores that claim to be probabilities with what was true. Throws InputError for a score outside [0, 1], and for no
/// bins.
Calibration calibration(const std::vector<Decision>& decisions, std::size_t num_bins = 10);

}  // namespace fabloop
