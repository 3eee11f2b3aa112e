// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "frontend/fabmap/belief.h"
#include "frontend/fabmap/inverted_index.h"
#include "frontend/fabmap/place_store.h"

namespace fabloop {

/// How the lag at which a place is dropped is found.
enum class BennettSolver {
  Newton,     ///< From the asymptote of small lags, which lies below; a few steps (Cummins & Newman 2010).
  Bisection,  ///< OpenFABMAP's; slower, and the same lag.
};

struct BailOutOptions {
  /// Probability with which the place that would have been best may be dropped, by Bennett's inequality. Higher is faster.
  double p_drop_best = 1e-6;
  /// A dropped place is also less likely than the best by at least this factor, however many places there are: all of them
  /// together keep less than it of the probability. Higher is faster.
  double negligible = 1e-6;
  std::size_t check_every = 10;  ///< Words between two looks at who has fallen behind. Fewer drop sooner and look more often.
  BennettSolver solver = BennettSolver::Newton;
};

/// Throws InputError unless both probabilities are in (0, 1) and there are words between checks.
void validate(const BailOutOptions& options);

/// log p(Z | L) of each place, exactly for those that were kept.
struct BailOutResult {
  std::vector<double> log_likelihood;  ///< Of each place; an upper bound for those dropped.
  std::vector<PlaceId> dropped;        ///< Ascending.
};

/// Bennett's inequality (Cummins & Newman 2010): an upper bound of the logarithm of the probability that a sum of independent
/// terms of mean zero, each at most `max_term`, with `variance` in all, exceeds `lag`.
double log_bennett_bound(double variance, double max_term, double lag);

/// The lag at which log_bennett_bound() is `log_p`, which is below zero.
double bennett_lag(double variance, double max_term, double log_p, BennettSolver solver);

/// The index's number with fewer words looked at (Cummins & Newman 2010): the words that tell places apart best come first, and
/// once the words to come would make up a place's lag behind the best with no more than `p_drop_best`, the place is dropped.
/// The bound of a dropped place holds with that probability too: what it has, what the words to come would add on average, and
/// Bennett's lag. When few are left, only they are finished.
BailOutResult log_likelihoods_with_bail_out(const WordTerms& terms, const VisitCounts& counts, const PlaceStore& places,
                                            const InvertedIndex& index, const Observation& observation,
                                            const BailOutOptions& options);

}  // namespace fabloop
