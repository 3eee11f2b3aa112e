// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/metric_pose.h"

#include <utility>

#include "verification/median.h"
#include "verification/pose/absolute_pose.h"

namespace fabloop {
namespace {

/// Points of one view with the other view's rays to them, in the order of the matches.
template <typename PointIndex, typename RayIndex>
std::vector<PointRay> points_and_rays(const View& with_points, const View& with_rays, const std::vector<Match>& matches,
                                      PointIndex point_index, RayIndex ray_index) {
  std::vector<PointRay> data;
  for (const Match& match : matches) {
    const auto& point = with_points.points_in_camera[static_cast<std::size_t>(match.*point_index)];
    if (point) data.push_back({*point, with_rays.rays[static_cast<std::size_t>(match.*ray_index)]});
  }
  return data;
}

/// Pose of the camera that has the rays, in the camera that has the points.
std::optional<MetricPose> points_from_rays(const std::vector<PointRay>& data, double focal_px, const MetricPoseOptions& options,
                                           std::uint64_t seed) {
  if (static_cast<int>(data.size()) < options.min_points) return std::nullopt;
  AbsolutePoseOptions pose_options;
  pose_options.max_error_rad = options.max_point_error_px / focal_px;
  pose_options.confidence = options.confidence;
  pose_options.seed = seed;
  const auto pose = estimate_absolute_pose(data, pose_options);
  if (!pose) return std::nullopt;
  std::vector<double> depths;
  for (const std::size_t i : pose->inliers)
    depths.push_back((data[i].point_in_world - pose->world_from_camera.translation).norm());
  MetricPose metric{pose->world_from_camera, static_cast<int>(pose->inliers.size()), 0, 0};
  metric.inlier_ratio = static_cast<double>(pose->inliers.size()) / static_cast<double>(data.size());
  metric.median_depth = median(std::move(depths));
  return metric;
}

}  // namespace

const MetricPose* MetricPoses::best() const {
  if (!from_match_points || !from_query_points) {
    return from_match_points ? &*from_match_points : (from_query_points ? &*from_query_points : nullptr);
  }
  return from_match_points->num_inliers >= from_query_points->num_inliers ? &*from_match_points : &*from_query_points;
}

MetricPoses estimate_metric_poses(const View& query, const View& match, const std::vector<Match>& matches,
                                  const MetricPoseOptions& options) {
  MetricPoses poses;
  poses.from_match_points = points_from_rays(points_and_rays(match, query, matches, &Match::match, &Match::query),
                                             feature_focal_px(query), options, options.seed);
  auto query_from_match = points_from_rays(points_and_rays(query, match, matches, &Match::query, &Match::match),
                                           feature_focal_px(match), options, options.seed + 1);
  if (query_from_match) {
    query_from_match->match_from_query = query_from_match->match_from_query.inverse();
    poses.from_query_points = std::move(query_from_match);
  }
  return poses;
}

}  // namespace fabloop
