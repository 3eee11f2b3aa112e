// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/point_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "frontend/geometry/camera.h"
#include "frontend/sequence/association.h"
#include "posegraph/sfm/track_triangulation.h"

namespace fabloop {
namespace {

constexpr double kLeastParallaxDeg = 2.0;

/// Where the reference's cameras see the point.
std::optional<Eigen::Vector3d> seen_by_reference(const Reconstruction& map, const ScenePoint& point,
                                                 const std::vector<std::optional<Pose>>& reference_from_cameras) {
  std::vector<Eigen::Vector3d> centres, rays;
  double largest_angle = 0;
  for (const Sighting& sighting : point.track) {
    const auto& pose = reference_from_cameras[sighting.image];
    if (!pose) continue;
    const Camera& camera = map.cameras[map.images[sighting.image].camera];
    centres.push_back(pose->translation);
    rays.push_back(pose->rotation * bearings(camera, {sighting.pixel}).front());
    for (const Eigen::Vector3d& other : rays) largest_angle = std::max(largest_angle, angle_between(other, rays.back()));
  }
  if (largest_angle < rad_from_deg(kLeastParallaxDeg)) return std::nullopt;
  return meeting_point(centres, rays);
}

}  // namespace

std::optional<PointError> point_error(const Reconstruction& map, const Trajectory& reference,
                                      const TrajectoryErrorOptions& options) {
  const auto aligned = absolute_trajectory_error(trajectory_of(map), reference, options);
  if (!aligned) return std::nullopt;
  std::vector<std::int64_t> times_ns;
  for (const PlacedImage& image : map.images) times_ns.push_back(image.time_ns);
  const auto max_difference_ns = static_cast<std::int64_t>(std::llround(1e9 * options.max_time_difference_s));
  const auto reference_from_cameras = poses_at(reference, times_ns, max_difference_ns);
  std::vector<double> across, height;
  for (const ScenePoint& point : map.points) {
    const auto expected = seen_by_reference(map, point, reference_from_cameras);
    if (!expected) continue;
    const Eigen::Vector3d apart = aligned->reference_from_estimate * point.x_in_world - *expected;
    across.push_back(apart.head<2>().norm());
    height.push_back(std::abs(apart.z()));
  }
  if (across.empty()) return std::nullopt;
  return PointError{error_statistics(std::move(across)), error_statistics(std::move(height))};
}

}  // namespace fabloop
