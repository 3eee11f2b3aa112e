// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/matching/match_consistency.h"
#include "verification/matching/matching.h"
#include "verification/view.h"

namespace fabloop {

struct GuidedMatchingOptions {
  /// Half the width of the epipolar band: largest Sampson distance, an angle (about 2 px over 500 px of focal length).
  double max_error_rad = 0.004;
  /// The ratio test among the features of the band. Raise it where the pose is sure and texture repeats.
  double max_ratio = 0.85;
  /// As in MatchingOptions.
  double same_spot_px = 2.0;
  /// Largest distance of descriptors, as a share of what two unrelated features typically are apart: a band may hold nothing
  /// that looks alike, and no second for the ratio test. Raise it for large changes of light or viewpoint.
  double max_relative_distance = 0.6;
  /// How the image turned and grew, as view_change() finds among the inliers of the first model: only features that agree are
  /// candidates, which keeps out most accidents at the price of one true match in fifty. None admits all.
  std::optional<ViewChange> change{};
  /// How far candidates may be off it.
  MatchConsistencyOptions consistency{};
};

/// Matches along a known epipolar geometry: features are compared only with those in their epipolar band and in front of both
/// cameras, and match when each is the other's nearest there and distinct among the band's. Where a texture repeats, that
/// finds pairs whose look-alikes elsewhere made match_features() refuse them. `match_from_query` may have a translation of any
/// length but zero. Most distinctive first; `ratio` is against the second best of the band, or against the typical distance
/// of unrelated features where that is nearer; at most one match a spot of the query.
///
/// Matches found so agree with the pose by construction: they refine it, but they prove nothing.
std::vector<Match> guided_matches(const View& query, const View& match, const Pose& match_from_query,
                                  const GuidedMatchingOptions& options = {});

}  // namespace fabloop
