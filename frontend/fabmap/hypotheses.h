// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "frontend/fabmap/belief.h"

namespace fabloop {

/// A place where the camera may be again.
struct Hypothesis {
  PlaceId place = 0;
  double probability = 0.0;     ///< Among the places not excluded, and the new place.
  double log_likelihood = 0.0;  ///< log p(Z | place).
};

struct HypothesesOptions {
  std::size_t max_hypotheses = 10;  ///< More when verification is cheap and recall matters.
  /// So many of the most recent places are left out, and out of the normalisation too: their views overlap the present one,
  /// and they would eat the probability of a true revisit. About as many as the images that share view with one another.
  std::size_t num_recent_excluded = 10;
  double min_probability = 0.0;  ///< Less likely ones are left out.
};

/// The places in order of falling probability, p(place | Z, neither excluded). Ordered by log probability, so that the order
/// holds where probabilities underflow; then by log-likelihood; then by index. Places ruled out by the prior never appear.
std::vector<Hypothesis> ranked_hypotheses(const Belief& belief, const HypothesesOptions& options = {});

}  // namespace fabloop
