// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "frontend/geometry/pose.h"
#include "frontend/geometry/readout_motion.h"
#include "posegraph/sfm/tracks.h"
#include "verification/view.h"

namespace fabloop {

/// What structure from motion starts from. Views and tracks must outlive it; tracks change only as merge_duplicate_points() does,
/// which keeps their numbers, and after which points of other segments no longer fit them.
struct Scene {
  const std::vector<View>& views;
  const TrackSet& tracks;
};

/// A point of a segment.
struct SegmentPoint {
  Eigen::Vector3d x_in_world = Eigen::Vector3d::Zero();
  std::vector<std::uint32_t> seen_by;  ///< Positions in its track of the placed views that agree, ascending; at least two.
};

/// Views that have their places in one world of arbitrary unit, with the points they see.
struct Segment {
  std::vector<std::optional<Pose>> world_from_cameras;  ///< One a view of the scene.
  std::vector<std::optional<SegmentPoint>> points;      ///< One a track of the scene.
  /// One a view of the scene, where a rolling shutter is modelled; empty: all rows of an image are seen from one pose.
  std::vector<ReadoutMotion> readout_motions{};
};

/// A segment without views.
Segment empty_segment(const Scene& scene);

std::size_t num_placed(const Segment& segment);
std::size_t num_points(const Segment& segment);

/// Where the feature of a view was detected.
Eigen::Vector2d pixel_of(const Scene& scene, const TrackFeature& member);

/// Where a placed view was when it saw a feature: its pose, moved on to the feature's row where a rolling shutter is modelled.
Pose pose_at_sighting(const Scene& scene, const Segment& segment, const TrackFeature& member);

/// Distance between where a placed view sees a point and where it should, in pixels of the image in which the view's features
/// were found; infinite behind the camera.
double sighting_error_px(const Scene& scene, const Segment& segment, const TrackFeature& member,
                         const Eigen::Vector3d& x_in_world);

struct ReprojectionStatistics {
  double mean_px = 0;  ///< Pixels of the images, shrunk or not.
  std::size_t num_sightings = 0;
};

/// Over all sightings of a segment's points.
ReprojectionStatistics reprojection_statistics(const Scene& scene, const Segment& segment);

}  // namespace fabloop
