// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "frontend/features/features.h"
#include "verification/matching/matching.h"

namespace fabloop {

struct SimilarGroupOptions {
  /// How far a match may be off where the similarity puts it, as a share of the larger extent of the match's keypoints: relief
  /// and tilt are no similarity.
  double max_offset = 0.05;
  double max_turn_difference_deg = 40;    ///< Of its keypoints' angles from the similarity's turn.
  double max_log2_growth_difference = 1;  ///< Of its keypoints' sizes from the similarity's growth, in octaves.
  std::size_t max_matches = 60;           ///< The most distinctive are looked at: time grows with their cube.
  std::size_t enough = 16;                ///< The count stops here.
};

/// The largest number of matches that one similarity of the image (shift, turn, growth) brings together: what Lowe's Hough
/// clusters find (Lowe 2004, section 7.3), here over all pairs of matches. Accidental matches rarely make four; three or four
/// true ones show a place long before an epipolar geometry stands out, which five accidental matches always have. It proves
/// nothing: it says where a closer look is worth while. `matches` with the most distinctive first.
std::size_t largest_similar_group(const Features& query, const Features& match, const std::vector<Match>& matches,
                                  const SimilarGroupOptions& options = {});

}  // namespace fabloop
