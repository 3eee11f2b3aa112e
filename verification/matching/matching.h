// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frontend/features/features.h"

namespace fabloop {

/// Among which features a match is the best, and the second best was looked for.
enum class RatioAmong {
  All,       ///< Of the match view.
  Band,      ///< Those near the epipolar line of a known pose.
  SameWord,  ///< Those of one visual word.
};

/// A feature of the query and the feature of the match that looks most like it.
struct Match {
  int query = 0;    ///< Index into the query's features.
  int match = 0;    ///< Index into the match's features.
  float ratio = 0;  ///< Distance to the best over distance to the second best: small is distinctive.
  RatioAmong ratio_among = RatioAmong::All;
};

/// How the most similar feature is looked for.
enum class MatchSearch {
  Exact,
  /// Of floats, in an eighth of the features (RowSearch::near_two): faster from some 6,000 features a view on, twice so at
  /// 12,000, three times at 20,000; 99 of 100 matches of real images are the same. Bits are compared exactly, which takes little
  /// time.
  Approximate,
};

struct MatchingOptions {
  /// Lowe's ratio test (Lowe 2004, section 7.1). Raise it for repetitive ground, where geometry then has more to sort out.
  double max_ratio = 0.85;
  /// Features closer than this show the same spot (SIFT gives a spot one feature per orientation), and the second best
  /// must show another one; in pixels of the image in which they were found. 0 counts every feature for itself.
  double same_spot_px = 2.0;
  MatchSearch search = MatchSearch::Exact;  ///< Approximate for many thousand features a view.
};

/// Matches that are each other's nearest and pass the ratio test, most distinctive first; at most one a spot of the query.
/// Distances are Euclidean for float descriptors and Hamming for bits. Both sides must be of one kind.
std::vector<Match> match_features(const Features& query, const Features& match, const MatchingOptions& options = {});

}  // namespace fabloop
