// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "frontend/features/features.h"
#include "verification/matching/matching.h"

namespace fabloop {

/// A value that more matches share than chance explains.
struct CommonValue {
  double value = 0;
  double share = 0;  ///< Of the matches that tell it, how many are within the tolerance of it.
};

/// How the image of a place turned and grew from the query to the match, by the keypoints of most matches.
struct ViewChange {
  std::optional<CommonValue> turn_deg;     ///< Keypoint angle in the match less that in the query, in [0, 360).
  std::optional<CommonValue> log2_growth;  ///< Binary logarithm of the keypoint's size in the match over that in the query.
};

struct MatchConsistencyOptions {
  /// How far a match may be off the common turn. A tilted view of a plane turns its parts by different angles: 45 degrees hold
  /// for views from up to some 60 degrees aside. Less where the camera always looks straight down.
  double max_turn_difference_deg = 45;
  /// The same for the growth, in octaves. Depths and tilt that differ across the image change it.
  double max_log2_growth_difference = 1.0;
  /// How many standard deviations more matches must share a value than would by chance. Below it there is no common value:
  /// the pair is a false one, and no match is called inconsistent. (Chance is an even spread. Small keypoints abound, so
  /// accidental matches share a growth, too: the turn says more.)
  double min_significance = 4.0;
};

/// The modes of smoothed histograms over all matches. Keypoints whose angle is unknown (-1) tell no turn.
ViewChange view_change(const Features& query, const Features& match, const std::vector<Match>& matches,
                       const MatchConsistencyOptions& options = {});

/// Whether a match follows the change of view; it does where it is unknown.
bool agrees_with(const ViewChange& change, const Features& query, const Features& match, const Match& candidate,
                 const MatchConsistencyOptions& options = {});

/// The matches that agree with their own change of view before the others, each in the order given: for estimators that draw
/// the first before the last (PROSAC). Loses none.
std::vector<Match> consistent_first(const Features& query, const Features& match, const std::vector<Match>& matches,
                                    const MatchConsistencyOptions& options = {});

/// Only those that agree. Views from the side, over rough ground and of near things lose true matches: prefer
/// consistent_first() unless time is short.
std::vector<Match> consistent_only(const Features& query, const Features& match, const std::vector<Match>& matches,
                                   const MatchConsistencyOptions& options = {});

}  // namespace fabloop
