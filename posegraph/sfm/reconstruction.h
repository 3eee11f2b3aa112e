// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <opencv2/core/matx.hpp>
#include <optional>
#include <vector>

#include "frontend/geometry/camera.h"
#include "frontend/geometry/geo_position.h"
#include "frontend/geometry/pose.h"
#include "frontend/geometry/readout_motion.h"
#include "frontend/sequence/trajectory.h"

namespace fabloop {

/// What one unit of a reconstruction's coordinates is.
enum class LengthUnit {
  Arbitrary,  ///< Images alone show no length.
  Metres,
};

/// An image that has its place.
struct PlacedImage {
  std::size_t frame = 0;  ///< Position in the sequence.
  std::filesystem::path image_path;
  std::int64_t time_ns = 0;
  std::size_t camera = 0;   ///< Index into Reconstruction::cameras.
  Pose world_from_camera;   ///< While the middle row is read.
  ReadoutMotion readout{};  ///< Of a rolling shutter, where the map was made under one; what is read from files has none.
};

/// Where an image shows a point.
struct Sighting {
  std::size_t image = 0;  ///< Index into Reconstruction::images.
  Eigen::Vector2d pixel;  ///< As detected, with the lens's distortion.
};

/// A point that several images show.
struct ScenePoint {
  Eigen::Vector3d x_in_world = Eigen::Vector3d::Zero();
  cv::Vec3b red_green_blue{0, 0, 0};
  std::vector<Sighting> track;  ///< At most one an image, in the images' order.
};

/// The result of structure from motion: cameras, images and points in one world. Plain data.
struct Reconstruction {
  std::vector<Camera> cameras;
  std::vector<PlacedImage> images;  ///< In the sequence's order; images without a place are absent.
  std::vector<ScenePoint> points;
  LengthUnit unit = LengthUnit::Arbitrary;
  std::optional<GeoPosition> origin;  ///< Where the world is east-north-up about a place on Earth (then in metres).
};

/// The images' places as a trajectory.
Trajectory trajectory_of(const Reconstruction& reconstruction);

/// Where a camera was when it saw a point: its pose, moved on to the sighting's row where a rolling shutter is modelled.
Pose pose_at_sighting(const Reconstruction& reconstruction, const Sighting& sighting);

}  // namespace fabloop
