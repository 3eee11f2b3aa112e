// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "verification/verifier.h"

namespace fabloop {

/// One figure of a verification, and what was wanted of it. The names are a public contract: they stand in files.
struct PairFigure {
  enum class Wanted {
    Anything,  ///< Told for its own sake.
    AtLeast,
    AtMost,
  };
  std::string_view name;         ///< "inliers": letters, digits and underscores, the unit last where it has one.
  std::string_view explanation;  ///< "matches that agree with the pose".
  std::optional<double> value;   ///< None: the gates before it were not passed.
  Wanted wanted = Wanted::Anything;
  double threshold = 0;

  /// Whether the value is as wanted; none without a value, or where nothing is wanted.
  std::optional<bool> is_passed() const;
};

/// Every figure of a verification in the order in which the gates ask for it, and what else tells how far to trust the pair:
/// the spread of the inliers, how far the texture repeats, and how the image turned. The one place where figures are listed:
/// programs print, draw and write what it gives.
std::vector<PairFigure> pair_figures(const View& query, const View& match, const Verification& found,
                                     const VerifierOptions& options);

/// Those of them that need no images: what a ledger's line tells.
std::vector<PairFigure> gate_figures(const Verification& found, const VerifierOptions& options);

/// What a verdict means, in a sentence for a person.
std::string_view meaning_of(Verdict verdict);

/// The name of the figure that decided on this verdict; empty where it was not one figure alone.
std::string_view gate_of(Verdict verdict);

/// "at least 15", "at most 0.5", or nothing.
std::string wanted_text(const PairFigure& figure);

/// Four significant digits, counts in full, "-" for none.
std::string value_text(const PairFigure& figure);

}  // namespace fabloop
