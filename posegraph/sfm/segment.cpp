// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/segment.h"

#include <algorithm>

#include "posegraph/sfm/bundle_adjustment.h"

namespace fabloop {

Segment empty_segment(const Scene& scene) {
  Segment segment;
  segment.world_from_cameras.resize(scene.views.size());
  segment.points.resize(scene.tracks.tracks.size());
  return segment;
}

std::size_t num_placed(const Segment& segment) {
  return static_cast<std::size_t>(std::count_if(segment.world_from_cameras.begin(), segment.world_from_cameras.end(),
                                                [](const auto& pose) { return pose.has_value(); }));
}

std::size_t num_points(const Segment& segment) {
  return static_cast<std::size_t>(
      std::count_if(segment.points.begin(), segment.points.end(), [](const auto& point) { return point.has_value(); }));
}

Eigen::Vector2d pixel_of(const Scene& scene, const TrackFeature& member) {
  const cv::Point2f& at = scene.views[member.view].features.keypoints[member.feature].pt;
  return {at.x, at.y};
}

Pose pose_at_sighting(const Scene& scene, const Segment& segment, const TrackFeature& member) {
  const Pose& world_from_camera = *segment.world_from_cameras[member.view];
  if (segment.readout_motions.empty()) return world_from_camera;
  const double share = readout_share(scene.views[member.view].camera, pixel_of(scene, member).y());
  return pose_at_row(world_from_camera, segment.readout_motions[member.view], share);
}

double sighting_error_px(const Scene& scene, const Segment& segment, const TrackFeature& member,
                         const Eigen::Vector3d& x_in_world) {
  const View& view = scene.views[member.view];
  return reprojection_error_px(view.camera, pose_at_sighting(scene, segment, member), x_in_world, pixel_of(scene, member)) /
         view.features.pixel_size;
}

ReprojectionStatistics reprojection_statistics(const Scene& scene, const Segment& segment) {
  ReprojectionStatistics statistics;
  for (std::size_t t = 0; t < segment.points.size(); ++t) {
    if (!segment.points[t]) continue;
    for (const std::uint32_t position : segment.points[t]->seen_by) {
      const TrackFeature& member = scene.tracks.tracks[t][position];
      statistics.mean_px +=
          scene.views[member.view].features.pixel_size * sighting_error_px(scene, segment, member, segment.points[t]->x_in_world);
      ++statistics.num_sightings;
    }
  }
  if (statistics.num_sightings > 0) statistics.mean_px /= static_cast<double>(statistics.num_sightings);
  return statistics;
}

}  // namespace fabloop
