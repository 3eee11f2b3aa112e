// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "frontend/geometry/readout_motion.h"
#include "tests/posegraph/sfm/synthetic_scene.h"

namespace fabloop::test {

/// A synthetic scene as a rolling shutter sees it. Strips are flown to and fro with cameras that turn as asked along each.
struct RollingShutterScene {
  static constexpr double kStepS = 2;
  static constexpr double kPauseS = 60;  ///< Between strips.
  static constexpr double kSpeed = 2.5;  ///< 5 from image to image.

  SyntheticScene scene;
  std::vector<std::int64_t> times_ns;
  std::vector<Eigen::Vector3d> velocities_in_world;
};

/// Sightings move to where a camera that is on its way sees the points.
inline RollingShutterScene make_rolling_shutter_scene(double readout_s, SyntheticSceneOptions options = {},
                                                      const Eigen::Vector3d& turn_per_s = Eigen::Vector3d::Zero()) {
  constexpr int kRounds = 20;  // the row decides when, and when decides the row: contracts by the shift over the height
  options.height_change = 0;
  std::mt19937_64 random(options.seed + 1);
  std::normal_distribution<double> noise(0, options.noise_px);
  SyntheticSceneOptions exact = options;
  exact.noise_px = 0;
  RollingShutterScene result;
  result.scene = make_synthetic_scene(exact);
  double time_s = 0;
  for (std::size_t strip = 0; strip < options.num_strips; ++strip) {
    for (std::size_t i = 0; i < options.views_per_strip; ++i) {
      result.times_ns.push_back(static_cast<std::int64_t>(1e9 * time_s));
      Eigen::Quaterniond& rotation = result.scene.world_from_cameras[result.velocities_in_world.size()].rotation;
      rotation = rotation * rotation_from_vector(result.kStepS * static_cast<double>(i) * turn_per_s);
      result.velocities_in_world.emplace_back(strip % 2 == 0 ? result.kSpeed : -result.kSpeed, 0, 0);
      time_s += result.kStepS;
    }
    time_s += result.kPauseS;
  }
  SyntheticScene& scene = result.scene;
  for (std::size_t t = 0; t < scene.tracks.tracks.size(); ++t) {
    for (const TrackFeature& member : scene.tracks.tracks[t]) {
      const ReadoutMotion motion{readout_s * turn_per_s, readout_s * result.velocities_in_world[member.view]};
      cv::Point2f& at = scene.views[member.view].features.keypoints[member.feature].pt;
      Eigen::Vector2d pixel(at.x, at.y);
      for (int round = 0; round < kRounds; ++round) {
        const Pose pose = pose_at_row(scene.world_from_cameras[member.view], motion, readout_share(scene.camera, pixel.y()));
        pixel = *project(scene.camera, pose.inverse() * scene.points_in_world[t]);
      }
      at = cv::Point2f(static_cast<float>(pixel.x() + noise(random)), static_cast<float>(pixel.y() + noise(random)));
    }
  }
  for (View& view : scene.views) view = make_view(view.frame, scene.camera, std::move(view.features));
  return result;
}

}  // namespace fabloop::test
