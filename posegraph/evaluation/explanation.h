// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "posegraph/run/ledger_table.h"
#include "verification/picture/pair_report.h"
#include "verification/verifier.h"

namespace fabloop {

/// Why a pair of frames did or did not become a loop.
struct Explanation {
  std::size_t query = 0, match = 0;
  std::optional<Verdict> verdict;          ///< None: the pair was never verified.
  Verification found;                      ///< As the ledger has it, without inliers and information.
  std::vector<PairFigure> gates;           ///< As far as they were asked.
  std::vector<std::string> words;          ///< Sentences: appearance, verdict, back end, and what would have to change.
  std::vector<const LedgerRow*> of_query;  ///< All hypotheses of the query, of the ledger that was given.
};

/// What a run knew when it decided.
struct ExplainOptions {
  VerifierOptions verifier;              ///< The gates' limits.
  std::size_t num_recent_excluded = 10;  ///< So many frames before the query were never asked.
};

/// Explains one pair, for a person. Throws InputError for a match that is not before its query.
Explanation explain(const LedgerTable& ledger, std::size_t query, std::size_t match, const ExplainOptions& options = {});

/// The figures of a ledger's line as a verification.
Verification verification_of(const LedgerTable& ledger, const LedgerRow& row);

}  // namespace fabloop
