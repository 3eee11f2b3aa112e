// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "frontend/geometry/pose.h"
#include "frontend/progress.h"
#include "frontend/work_state.h"
#include "posegraph/sfm/candidate_pairs.h"
#include "verification/matching/matching.h"
#include "verification/view.h"

namespace fabloop {

struct ViewGraphOptions {
  MatchingOptions matching;
  /// A first look with so many features, which costs little, sorts out pairs that share nothing.
  std::size_t num_first_features = 700;
  std::size_t min_first_group = 4;       ///< Least largest_similar_group() of the first look.
  std::size_t min_inliers = 16;          ///< Fewer prove no overlap.
  double max_error_px = 2.0;             ///< Largest distance from the epipolar plane. As the verifier's.
  double max_log10_false_alarms = -6.0;  ///< Of accidental matches; see evidence.h. Tracks and bundle adjustment sort out more.
  int max_iterations = 2000;             ///< RANSAC's bound.
  std::uint64_t seed = 1;
  int num_threads = 0;  ///< 0: all. The result does not depend on it.
  /// Where what became of the candidates is kept, some together, and looked up instead of found again. Not owned; null: nowhere.
  WorkState* state = nullptr;
  Progress progress;
};

/// Two views that overlap, with the matches that prove it.
struct ViewPair {
  std::size_t query = 0;
  std::size_t match = 0;
  std::size_t num_matches = 0;
  std::vector<Match> inliers;
  Pose match_from_query;           ///< Translation of unit length.
  double median_parallax_deg = 0;  ///< Between the inliers' rays, rotation undone.
  double rotation_share = 0;       ///< Of the inliers, how many a rotation alone explains: near 1 there is no baseline.
  double planar_ratio = 0;         ///< Of the inliers, how many one plane explains.
  bool has_rival = false;          ///< Another pose of that plane explains them nearly as well.
};

/// Matches the candidates and keeps what geometry proves (five points, RANSAC, a-contrario test), in their order.
std::vector<ViewPair> verify_pairs(const std::vector<View>& views, const std::vector<CandidatePair>& candidates,
                                   const ViewGraphOptions& options = {});

}  // namespace fabloop
