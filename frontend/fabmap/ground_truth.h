// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "frontend/fabmap/loop_matrix.h"
#include "frontend/fabmap/match_truth.h"
#include "frontend/fabmap/pair_truth.h"
#include "frontend/geometry/pose.h"

namespace fabloop {

/// What matches are judged against.
struct GroundTruth {
  std::size_t num_queries = 0;  ///< Frames that are looked up.
  std::size_t num_matches = 0;  ///< Frames that they may be matched with.
  /// The truth of one pair of frames, each below its number.
  std::function<MatchTruth(std::size_t query, std::size_t match)> at;
  bool within_one_sequence = false;  ///< Queries and matches are frames of one sequence; a query can only match earlier ones.
  std::string recipe;                ///< The rules in words, with their figures: what a reader must know to compare.
};

/// When two camera poses show the same place.
struct PoseRules {
  double radius_m = 10.0;  ///< Camera centres closer than this are a true match. About half of what one image shows.
  /// Where heading matters: the optical axes must be within this angle too. A larger angle is false. Not for cameras that look
  /// down, whose axes are parallel whatever their heading.
  std::optional<double> max_angle_deg{};
  /// Centres from radius_m up to this are not judged, for pairs that may or may not share view. None: no such ring.
  std::optional<double> not_judged_radius_m{};
};

/// Frames of one sequence that are no further apart than this are neighbours in time, and neither right nor wrong. None: the
/// queries are of another sequence than the matches, and every pair is judged.
using ExclusionWindow = std::optional<std::size_t>;

/// The truth that a matrix holds. Throws InputError for a window over a matrix that is not square.
GroundTruth truth_from_matrix(LoopMatrix matrix, const ExclusionWindow& window);

/// The truth by poses in one world frame; pairs in which one has none are not judged. For one sequence, its poses twice. Throws
/// InputError for rules that make no sense.
GroundTruth truth_from_poses(std::vector<std::optional<Pose>> queries, std::vector<std::optional<Pose>> matches,
                             const ExclusionWindow& window, const PoseRules& rules = {});

/// The truth by the pairs of one sequence. Frames that lack a reference (`has_reference`, one entry a frame) are not judged.
GroundTruth truth_from_pairs(PairTruths pairs, std::vector<bool> has_reference, const ExclusionWindow& window,
                             const PairRules& rules = {});

}  // namespace fabloop
