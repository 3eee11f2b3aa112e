// SPDX-License-Identifier: BSD-3-Clause
#include "verification/neighbour.h"

#include <vector>

#include "verification/edge_information.h"
#include "verification/ray_pairs.h"
#include "verification/relative_pose.h"

namespace fabloop {
namespace {

/// The odometry's start is as good as RANSAC's when it keeps this share of the inliers.
constexpr double kAsManyInliers = 0.9;

/// The relative pose from the images: the one that the odometry leads to when it explains as much as the best one.
std::optional<RelativePose> relative_pose_near(const std::vector<RayPair>& pairs, const Pose& odometry,
                                               const RelativePoseOptions& options) {
  auto best = estimate_relative_pose(pairs, options);
  auto near = refine_relative_pose(pairs, odometry, options);
  if (!best || !near) return best ? best : near;
  const bool as_good = static_cast<double>(near->inliers.size()) >= kAsManyInliers * static_cast<double>(best->inliers.size());
  return as_good ? near : best;
}

int triangulate_inliers(View& previous, View& current, const std::vector<Match>& matches, const std::vector<RayPair>& pairs,
                        const RelativePose& relative, const Pose& previous_from_current, const TriangulationOptions& options) {
  const Pose current_from_previous = previous_from_current.inverse();
  int num_points = 0;
  for (const std::size_t i : relative.inliers) {
    const auto x_in_previous = triangulate(pairs[i].match, pairs[i].query, previous_from_current, options);
    if (!x_in_previous) continue;
    const double parallax_rad = angle_between(*x_in_previous, *x_in_previous - previous_from_current.translation);
    add_point_measurement(previous, static_cast<std::size_t>(matches[i].match), *x_in_previous, parallax_rad);
    add_point_measurement(current, static_cast<std::size_t>(matches[i].query), current_from_previous * *x_in_previous,
                          parallax_rad);
    ++num_points;
  }
  return num_points;
}

}  // namespace

std::optional<NeighbourLink> link_neighbours(View& previous, View& current, const Pose& previous_from_current_odometry,
                                             const NeighbourOptions& options) {
  const double baseline = previous_from_current_odometry.translation.norm();
  const std::vector<Match> matches = match_features(current.features, previous.features, options.matching);
  if (static_cast<int>(matches.size()) < options.min_inliers || baseline <= 0) return std::nullopt;
  const std::vector<RayPair> pairs = ray_pairs(current, previous, matches);
  RelativePoseOptions pose_options;
  pose_options.max_error_rad = options.max_error_px / previous.camera.focal_px();
  pose_options.max_iterations = options.max_iterations;
  pose_options.seed = options.seed;
  const auto relative = relative_pose_near(pairs, previous_from_current_odometry, pose_options);
  if (!relative || static_cast<int>(relative->inliers.size()) < options.min_inliers) return std::nullopt;

  const Pose& seen = relative->match_from_query;
  NeighbourLink link;
  link.previous = previous.frame;
  link.rotation_error_deg = deg_from_rad(seen.rotation.angularDistance(previous_from_current_odometry.rotation));
  link.direction_error_deg = deg_from_rad(angle_between(seen.translation, previous_from_current_odometry.translation));
  const double parallax_deg = deg_from_rad(median_parallax(pairs, relative->inliers, seen));
  if (link.rotation_error_deg > options.max_rotation_error_deg || link.direction_error_deg > options.max_direction_error_deg ||
      parallax_deg < options.min_parallax_deg) {
    return std::nullopt;
  }
  link.previous_from_current = {seen.rotation, baseline * seen.translation};
  link.information = direction_edge_information(*relative).information;
  link.num_inliers = static_cast<int>(relative->inliers.size());
  link.num_points =
      triangulate_inliers(previous, current, matches, pairs, *relative, link.previous_from_current, options.triangulation);
  return link;
}

}  // namespace fabloop
