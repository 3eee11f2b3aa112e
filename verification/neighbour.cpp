// SPDX-License-Identifier: BSD-3-Clause
#include "verification/neighbour.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "frontend/parallel.h"
#include "verification/edge_information.h"
#include "verification/pair_seed.h"
#include "verification/pose/ray_pairs.h"
#include "verification/pose/relative_pose.h"

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

std::vector<NeighbourPoint> triangulate_inliers(const std::vector<Match>& matches, const std::vector<RayPair>& pairs,
                                                const RelativePose& relative, const Pose& previous_from_current,
                                                const TriangulationOptions& options) {
  std::vector<NeighbourPoint> points;
  for (const std::size_t i : relative.inliers) {
    const auto x_in_previous = triangulate(pairs[i].match, pairs[i].query, previous_from_current, options);
    if (!x_in_previous) continue;
    const double parallax_rad = angle_between(*x_in_previous, *x_in_previous - previous_from_current.translation);
    points.push_back(
        {static_cast<std::size_t>(matches[i].match), static_cast<std::size_t>(matches[i].query), *x_in_previous, parallax_rad});
  }
  return points;
}

}  // namespace

std::optional<SeenNeighbour> see_neighbour(const View& previous, const View& current, const Pose& previous_from_current_odometry,
                                           const NeighbourOptions& options) {
  const double baseline = previous_from_current_odometry.translation.norm();
  const std::vector<Match> matches = match_features(current.features, previous.features, options.matching);
  if (static_cast<int>(matches.size()) < options.min_inliers || baseline <= 0) return std::nullopt;
  const std::vector<RayPair> pairs = ray_pairs(current, previous, matches);
  RelativePoseOptions pose_options;
  pose_options.max_error_rad = options.max_error_px / feature_focal_px(previous);
  pose_options.max_iterations = options.max_iterations;
  pose_options.seed = pair_seed(options.seed, current.frame, previous.frame);
  const auto relative = relative_pose_near(pairs, previous_from_current_odometry, pose_options);
  if (!relative || static_cast<int>(relative->inliers.size()) < options.min_inliers) return std::nullopt;

  const Pose& seen = relative->match_from_query;
  SeenNeighbour result;
  NeighbourLink& link = result.link;
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
  result.points = triangulate_inliers(matches, pairs, *relative, link.previous_from_current, options.triangulation);
  link.num_points = static_cast<int>(result.points.size());
  return result;
}

void give_depths(View& recent, View& current, const RecentNeighbour& neighbour) {
  if (neighbour.seen.points.empty()) return;
  const Pose current_from_recent = neighbour.seen.link.previous_from_current.inverse();
  const auto gets_them = [&](View& view) {
    if (neighbour.unit_sigma > 0) return count_points(view) == 0;
    if (view.unit_sigma > 0) clear_points(view);
    return true;
  };
  const bool recent_does = gets_them(recent), current_does = gets_them(current);
  if (recent_does) recent.unit_sigma = neighbour.unit_sigma;
  if (current_does) current.unit_sigma = neighbour.unit_sigma;
  for (const NeighbourPoint& point : neighbour.seen.points) {
    if (recent_does) add_point_measurement(recent, point.previous_feature, point.x_in_previous, point.parallax_rad);
    if (current_does) {
      add_point_measurement(current, point.current_feature, current_from_recent * point.x_in_previous, point.parallax_rad);
    }
  }
}

std::optional<NeighbourLink> link_neighbours(View& previous, View& current, const Pose& previous_from_current_odometry,
                                             const NeighbourOptions& options) {
  auto seen = see_neighbour(previous, current, previous_from_current_odometry, options);
  if (!seen) return std::nullopt;
  const RecentNeighbour neighbour{0, std::move(*seen)};
  give_depths(previous, current, neighbour);
  return neighbour.seen.link;
}

std::vector<RecentNeighbour> see_recent(std::span<const RecentView> recent, const View& current, std::size_t max_links,
                                        const NeighbourOptions& options, int num_threads) {
  // Of steps alike, whose relative error never grows while the camera goes straight on. While it stands there is no step.
  constexpr double kAsWell = 1.2, kNoStep = 0.5;
  const auto step = std::find_if(recent.begin(), recent.end(), [](const RecentView& v) { return v.distance_sigma < kNoStep; });
  const double max_distance_sigma =
      std::max(options.max_distance_sigma, step == recent.end() ? 0.0 : kAsWell * step->distance_sigma);
  std::vector<RecentNeighbour> found;
  std::size_t next = 0;
  while (found.size() < max_links && next < recent.size()) {
    // As many as are still wanted: those that one thread would look at, too.
    std::vector<std::optional<SeenNeighbour>> seen(std::min(max_links - found.size(), recent.size() - next));
    parallel_for(seen.size(), num_threads, [&](std::size_t i) {
      const RecentView& earlier = recent[next + i];
      seen[i] = see_neighbour(*earlier.view, current, earlier.recent_from_current, options);
    });
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const double sigma = recent[next + i].distance_sigma;
      if (!seen[i] || !std::isfinite(sigma)) continue;
      found.push_back({next + i, std::move(*seen[i]), sigma > max_distance_sigma ? sigma : 0.0});
    }
    next += seen.size();
  }
  return found;
}

}  // namespace fabloop
