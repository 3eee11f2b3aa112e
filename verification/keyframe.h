// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "frontend/features/features.h"
#include "frontend/geometry/camera.h"
#include "frontend/geometry/pose.h"
#include "verification/view.h"

namespace fabloop {

/// One image as a host hands it over, with what the host knows of it.
struct Keyframe {
  std::size_t frame = 0;               ///< The host's number for it; ascending.
  std::int64_t time_ns = 0;            ///< The host's stamp; never falls.
  Pose odom_from_body{};               ///< The host's odometry.
  cv::Mat image{};                     ///< 8-bit grey (`CV_8UC1`), of the camera's size. Either this or `features`.
  std::optional<Features> features{};  ///< Extracted with the model's options.
  /// Covariance of the odometry's step from the keyframe handed over before: of (translation, rotation) in this body's axes, as
  /// in UncertainPose.
  std::optional<Eigen::Matrix<double, 6, 6>> step_covariance{};
  /// The point that each feature shows, where it is known: camera frame, the odometry's unit of length. Empty for none.
  std::vector<std::optional<Eigen::Vector3d>> points_in_camera{};
  /// Instead of points: depth along the optical axis, of the camera's size; metres (`CV_32FC1`) or units (`CV_16UC1`). Zero
  /// and what is not finite mean unknown.
  cv::Mat depth{};
  double depth_unit_m = 0.001;  ///< Metres a unit of a 16-bit depth image; 0.0002 for TUM RGB-D.
  /// Height of the camera above the ground (laser, sonar, barometer over level ground), in the odometry's unit of length: gives
  /// loops over a plane their scale where points do not.
  std::optional<double> height_above_ground{};
};

/// Throws InputError that names the keyframe, what is inconsistent in it, and how to mend it. Features must have descriptors of
/// the given kind, their length apart.
void validate(const Keyframe& keyframe, const Camera& camera, DescriptorKind descriptor_kind);

/// Throws InputError when a keyframe's number does not rise, or its stamp falls, from those of the one before.
void require_follows(const Keyframe& keyframe, std::size_t last_frame, std::int64_t last_time_ns);

/// The view that a valid keyframe shows: its features (or those extracted from its image), with the host's points, known to
/// `point_sigma` of their depth. Throws InputError when the points do not lie on the rays of their features, which they do only
/// in the camera's frame.
View view_of(const Keyframe& keyframe, const Camera& camera, Features features, double point_sigma);

}  // namespace fabloop
