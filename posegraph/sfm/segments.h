// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "posegraph/sfm/growth.h"
#include "posegraph/sfm/segment.h"

namespace fabloop {

struct JoinOptions {
  /// Standard deviation of a segment's points, as a share of the median distance from which they are seen. More joins segments
  /// that are bent.
  double point_sigma = 0.02;
  std::size_t min_inliers = 12;   ///< Shared points that must agree with one similarity.
  double min_inlier_share = 0.3;  ///< Of the points that both have.
  GrowthOptions growth;
  std::uint64_t seed = 1;
};

/// Joins segments that share enough points: the smaller is moved into the larger by the similarity that most of them agree on
/// (Umeyama 1991, RANSAC), and both are adjusted as one. What joins nothing stays. The largest first.
std::vector<Segment> join_segments(const Scene& scene, std::vector<Segment> segments, const JoinOptions& options = {});

}  // namespace fabloop
