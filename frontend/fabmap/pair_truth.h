// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "frontend/fabmap/match_truth.h"

namespace fabloop {

/// What a truth says about a pair of frames.
struct PairTruth {
  double overlap = 0.0;         ///< Part of the smaller footprint that both see, in [0, 1].
  std::size_t num_inliers = 0;  ///< Of an independent match; 0 where none was tried.
};

/// Pairs (i, j), i < j, by frame positions; an absent pair has no overlap.
using PairTruths = std::map<std::pair<std::size_t, std::size_t>, PairTruth>;

/// When a pair shows the same place. The defaults are those of the aerial sequences' ground truth.
struct PairRules {
  double min_true_overlap = 0.2;      ///< A pair with this overlap is true,
  std::size_t min_true_inliers = 15;  ///< as is one with this many inliers of an independent match.
  double max_false_overlap = 0.05;    ///< A pair below this overlap and below `min_true_inliers` is false.
};

/// What the rules make of a pair; those between true and false are not judged.
MatchTruth judge_pair(const PairTruth& pair, const PairRules& rules = {});

/// The pair of frames a and b, in any order.
PairTruth pair_between(const PairTruths& pairs, std::size_t a, std::size_t b);

/// "a pair is true with overlap >= 0.2 or ...".
std::string in_words(const PairRules& rules);

/// Reads `pairs.csv` lines `i,j,distance,overlap,inliers` (the last two may be empty). Throws InputError naming file and line.
PairTruths read_pairs(const std::filesystem::path& path);

}  // namespace fabloop
