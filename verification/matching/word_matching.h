// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "frontend/fabmap/observation.h"
#include "verification/matching/matching.h"

namespace fabloop {

struct WordMatchingOptions {
  /// Within a word, and of the exact search among the rest.
  MatchingOptions matching;
  /// With fewer matches from shared words, the rest is searched exactly: words of a vocabulary that was trained elsewhere part
  /// features that look alike. 0 never does, which bounds the time.
  std::size_t min_matches = 100;
  /// Largest distance of descriptors, as a share of what two unrelated features typically are apart: a word may hold features
  /// that look little alike, and no second for the ratio test.
  double max_relative_distance = 0.7;
};

/// Matches that prefer the words which FAB-MAP's recognition rests on: a feature is compared only with those of its own word
/// (`query_words` and `match_words` name each feature's, as WordFinder::nearest_words() does), mutually, with the ratio test
/// within the word; where the word holds no second, the ratio is 0. Most are found in a hundredth of the time. Matches of rare
/// words come first (fewest pairs of features, then by ratio), since a word that one feature has leaves no doubt which; those
/// of the exact search follow, by ratio. `ratio_among` tells them apart. At most one match a spot of the query.
std::vector<Match> match_shared_words(const Features& query, std::span<const WordId> query_words, const Features& match,
                                      std::span<const WordId> match_words, const WordMatchingOptions& options = {});

}  // namespace fabloop
