// SPDX-License-Identifier: BSD-3-Clause
#include "verification/map/keyframe_map.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace fabloop {
namespace {

/// The step that ends at a keyframe.
UncertainPose step_to(const KeyframeMap& map, std::size_t place, const OdometryStepNoise& noise) {
  const MapKeyframe& keyframe = map.keyframes[place];
  const Pose step = map.keyframes[place - 1].odom_from_body.inverse() * keyframe.odom_from_body;
  return keyframe.step_covariance ? UncertainPose{step, *keyframe.step_covariance} : uncertain_step(step, noise);
}

}  // namespace

UncertainPose uncertain_step(const Pose& a_from_b, const OdometryStepNoise& noise) {
  UncertainPose step{a_from_b};
  const double translation_sigma = noise.translation * a_from_b.translation.norm();
  const double rotation_sigma = rad_from_deg(noise.rotation_deg);
  step.covariance.diagonal().head<3>().setConstant(translation_sigma * translation_sigma);
  step.covariance.diagonal().tail<3>().setConstant(rotation_sigma * rotation_sigma);
  return step;
}

std::size_t position_of(const KeyframeMap& map, std::size_t session, std::size_t frame) {
  const auto comes_before = [](const MapKeyframe& keyframe, const std::pair<std::size_t, std::size_t>& sought) {
    return std::pair(keyframe.session, keyframe.view.frame) < sought;
  };
  const auto found = std::lower_bound(map.keyframes.begin(), map.keyframes.end(), std::pair(session, frame), comes_before);
  assert(found != map.keyframes.end() && found->session == session && found->view.frame == frame);
  return static_cast<std::size_t>(found - map.keyframes.begin());
}

UncertainPose odometry_between(const KeyframeMap& map, std::size_t a, std::size_t b, const OdometryStepNoise& noise) {
  assert(map.keyframes[a].session == map.keyframes[b].session);
  if (b < a) return inverse(odometry_between(map, b, a, noise));
  UncertainPose a_from_b;
  for (std::size_t place = a + 1; place <= b; ++place) a_from_b = a_from_b * step_to(map, place, noise);
  return a_from_b;
}

}  // namespace fabloop
