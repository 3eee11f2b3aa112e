// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/matching/matching.h"
#include "verification/view.h"

namespace fabloop {

struct ScaleOptions {
  int min_points = 12;             ///< Matches with known depth that must agree. Fewer: there is no scale.
  double min_parallax_rad = 0.01;  ///< Between the rays of a match. Below it their own depth is noise.
  /// How far, relative, a known depth may be off: beyond it a point counts as wrong. Depths by odometry and two neighbours are
  /// off by a few per cent together; stereo's far ones by more.
  double max_relative_error = 0.2;
  double min_share = 0.5;  ///< Of the points that tell a depth, how many must agree.
};

/// The length of a translation whose direction is known, by points whose depth is.
struct Scale {
  /// Whether enough points tell one length. Where they do not, the points or the pose are wrong.
  bool agrees = false;
  double baseline = 0;        ///< Length of the translation, in the unit of the points.
  double relative_sigma = 0;  ///< Standard deviation of the baseline over the baseline, from the scatter of the points.
  int num_points = 0;         ///< That agree.
  double share = 0;           ///< Of those that tell a depth.
  double median_depth = 0;    ///< Of those that agree, from the match.
  /// Logarithm of how much likelier the points are than depths at random, as if a handful of them told all: their errors are
  /// shared (a tilted surface). What two poses' figures differ by tells which of them the points support.
  double log_likelihood = 0;
};

/// What the points of either side say about the unit of a pose: each known depth over the depth that its match's rays meet at
/// with a baseline of one; the robust mean of the logarithms. None where fewer points than `min_points` tell a depth.
/// `match_from_query` has a unit translation, and `matches` agree with it.
std::optional<Scale> estimate_scale(const View& query, const View& match, const std::vector<Match>& matches,
                                    const Pose& match_from_query, const ScaleOptions& options = {});

}  // namespace fabloop
