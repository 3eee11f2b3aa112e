// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/camera_rates.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

#include "frontend/geometry/pose.h"
#include "verification/median.h"

namespace fabloop {
namespace {

/// From one placed camera to the next.
struct Step {
  double duration_s = 0;
  Eigen::Vector3d way = Eigen::Vector3d::Zero();         ///< In the world.
  Eigen::Vector3d turn_per_s = Eigen::Vector3d::Zero();  ///< In the camera's frame.
  bool is_pause = false;
};

std::vector<Step> steps_between(const std::vector<Pose>& poses, const std::vector<double>& times_s) {
  constexpr double kPause = 4.0;  // times the usual step
  std::vector<Step> steps;
  std::vector<double> durations_s;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    Step step;
    step.duration_s = times_s[i + 1] - times_s[i];
    step.way = poses[i + 1].translation - poses[i].translation;
    if (step.duration_s > 0) {
      step.turn_per_s = vector_from_rotation(poses[i].rotation.conjugate() * poses[i + 1].rotation) / step.duration_s;
      durations_s.push_back(step.duration_s);
    }
    steps.push_back(step);
  }
  const double longest_s = kPause * median(std::move(durations_s));
  for (Step& step : steps) step.is_pause = !(step.duration_s > 0) || step.duration_s > longest_s;
  return steps;
}

/// How well the turning rate of one step tells that of the next: their correlation about zero, that of the median camera.
double steadiness_of_turns(const std::vector<Step>& steps) {
  std::vector<double> correlations;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    const Eigen::Vector3d& before = steps[i].turn_per_s;
    const Eigen::Vector3d& after = steps[i + 1].turn_per_s;
    const double squares = before.squaredNorm() + after.squaredNorm();
    if (!steps[i].is_pause && !steps[i + 1].is_pause && squares > 0) correlations.push_back(2.0 * before.dot(after) / squares);
  }
  return std::max(0.0, median(std::move(correlations)));
}

/// The rate between the steps [first, middle) and [middle, last), of which there is at least one; none is a pause.
CameraRate rate_of(const std::vector<Step>& steps, std::size_t first, std::size_t middle, std::size_t last, double steadiness) {
  double length = 0;
  double duration_s = 0;
  for (std::size_t i = first; i < last; ++i) {
    length += steps[i].way.norm();
    duration_s += steps[i].duration_s;
  }
  const Step& before = steps[middle > first ? middle - 1 : middle];
  const Step& after = steps[middle < last ? middle : middle - 1];
  const double lengths = before.way.norm() * after.way.norm();
  CameraRate rate;
  if (lengths > 0) {
    const double straightness = std::max(0.0, before.way.dot(after.way) / lengths);
    rate.velocity_in_world_per_s = straightness * length / duration_s * (before.way + after.way).normalized();
  }
  const double local_s = before.duration_s + after.duration_s;
  rate.turn_per_s = steadiness * (before.duration_s * before.turn_per_s + after.duration_s * after.turn_per_s) / local_s;
  return rate;
}

}  // namespace

std::vector<CameraRate> camera_rates(const std::vector<std::optional<Pose>>& world_from_cameras,
                                     const std::vector<std::int64_t>& times_ns) {
  assert(world_from_cameras.size() == times_ns.size());
  constexpr std::size_t kSteps = 3;  // on either side: stamps of whole seconds at steps of two tell the speed to 4 %
  std::vector<std::size_t> placed;
  std::vector<Pose> poses;
  std::vector<double> times_s;
  for (std::size_t i = 0; i < world_from_cameras.size(); ++i) {
    if (!world_from_cameras[i]) continue;
    placed.push_back(i);
    poses.push_back(*world_from_cameras[i]);
    times_s.push_back(1e-9 * static_cast<double>(times_ns[i] - times_ns.front()));
  }
  std::vector<CameraRate> rates(world_from_cameras.size());
  const std::vector<Step> steps = steps_between(poses, times_s);
  const double steadiness = steadiness_of_turns(steps);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    std::size_t first = i;
    std::size_t last = i;
    while (first > 0 && i - first < kSteps && !steps[first - 1].is_pause) --first;
    while (last < steps.size() && last - i < kSteps && !steps[last].is_pause) ++last;
    if (first < last) rates[placed[i]] = rate_of(steps, first, i, last, steadiness);
  }
  return rates;
}

std::vector<ReadoutMotion> readout_motions(const std::vector<CameraRate>& rates, double readout_s) {
  std::vector<ReadoutMotion> motions;
  for (const CameraRate& rate : rates) {
    motions.push_back({readout_s * rate.turn_per_s, readout_s * rate.velocity_in_world_per_s});
  }
  return motions;
}

}  // namespace fabloop
