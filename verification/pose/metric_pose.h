// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/matching/matching.h"
#include "verification/view.h"

namespace fabloop {

struct MetricPoseOptions {
  int min_points = 12;              ///< Matches with known depth from which scale is taken.
  double max_point_error_px = 4.0;  ///< Between a point's pixel and where the pose puts it. As the verifier's.
  double confidence = 0.999;        ///< RANSAC's.
  std::uint64_t seed = 0;
};

/// The relative pose of two views in the unit of their points.
struct MetricPose {
  Pose match_from_query;
  int num_inliers = 0;
  double inlier_ratio = 0;  ///< Of the matches with known depth.
  double median_depth = 0;  ///< Of the inliers.
};

/// From the points of one view and the rays of the other.
struct MetricPoses {
  std::optional<MetricPose> from_match_points;
  std::optional<MetricPose> from_query_points;

  /// The one with more inliers; none when neither view has enough points.
  const MetricPose* best() const;
};

/// Metric poses by RANSAC over OpenGV's three-point solver, one a side, among matches that already agree epipolarly.
MetricPoses estimate_metric_poses(const View& query, const View& match, const std::vector<Match>& matches,
                                  const MetricPoseOptions& options = {});

}  // namespace fabloop
