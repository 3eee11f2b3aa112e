// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "frontend/fabmap/observation.h"
#include "frontend/geometry/camera.h"
#include "frontend/geometry/pose.h"
#include "verification/uncertain_pose.h"
#include "verification/view.h"

namespace fabloop {

/// One run of one camera whose poses share an odometry frame.
struct MapSession {
  Camera camera;
  Pose body_from_camera;
};

/// A keyframe as a loop closer remembers it: one place of FAB-MAP's.
struct MapKeyframe {
  std::size_t session = 0;  ///< Position in KeyframeMap::sessions.
  std::int64_t time_ns = 0;
  Pose odom_from_body;                                         ///< In the odometry of its session.
  std::optional<Eigen::Matrix<double, 6, 6>> step_covariance;  ///< As Keyframe::step_covariance.
  Observation words;
  View view;  ///< `view.frame` is the host's number of it; ascending in a session.
};

/// All keyframes of one or several sessions in order: what later keyframes are compared with.
struct KeyframeMap {
  std::string model_hash;  ///< Of the model that the words are of; see model_hash().
  std::vector<MapSession> sessions;
  std::vector<MapKeyframe> keyframes;  ///< By session, then by frame.
};

/// Where the map has the keyframe `frame` of a session. It must have it.
std::size_t position_of(const KeyframeMap& map, std::size_t session, std::size_t frame);

/// How far a step of the odometry is off, one standard deviation, where the host gives no covariance.
struct OdometryStepNoise {
  double rotation_deg = 1.0;  ///< Each axis.
  double translation = 0.05;  ///< Each axis, as a share of the step's length.
};

/// A step of an odometry whose host gives no covariance.
UncertainPose uncertain_step(const Pose& a_from_b, const OdometryStepNoise& noise = {});

/// a_from_b of two keyframes of one session, by the odometry: bodies, with what the steps between them are uncertain by.
/// `a` and `b` are positions in the map.
UncertainPose odometry_between(const KeyframeMap& map, std::size_t a, std::size_t b, const OdometryStepNoise& noise = {});

}  // namespace fabloop
