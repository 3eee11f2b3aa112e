// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/camera_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "frontend/parallel.h"

namespace fabloop {
namespace {

struct Cost {
  double cost = 0;
  double per_error = 0;  ///< Per one of a sighting's two errors, px^2.
};

/// The least cost with the focal length held at so much of the given one.
Cost least_cost(const Scene& scene, const Segment& segment, double factor, const CameraCheckOptions& options) {
  Segment copy = segment;
  SegmentAdjustmentOptions adjustment = options.adjustment;
  Camera camera = scene.views.front().camera;
  camera.fx *= factor;
  camera.fy *= factor;
  adjustment.camera = camera;
  const SegmentAdjustment adjusted = adjust_segment(scene, copy, adjustment);
  return {adjusted.final_cost, adjusted.final_cost / static_cast<double>(2 * std::max<std::size_t>(1, adjusted.num_sightings))};
}

}  // namespace

CameraCheck check_camera(const Scene& scene, const Segment& segment, const CameraCheckOptions& options) {
  constexpr int kRounds = 3;  // Newton steps towards a focal length that is far off
  constexpr double kMaxStep = 0.15;
  CameraCheck check;
  for (int round = 0; round < kRounds; ++round) {
    const double at = check.best_focal_factor;
    std::array<Cost, 3> costs;
    parallel_for(costs.size(), options.num_threads, [&](std::size_t i) {
      costs[i] = least_cost(scene, segment, at * (1.0 + (static_cast<double>(i) - 1.0) * options.probe), options);
    });
    const auto& [shorter, middle, longer] = costs;
    const double slope = (longer.cost - shorter.cost) / (2.0 * options.probe);
    const double curvature = (longer.cost - 2.0 * middle.cost + shorter.cost) / (options.probe * options.probe);
    check.relative_sigma = curvature > 0 ? std::sqrt(options.redundancy * 2.0 * middle.per_error / curvature)
                                         : std::numeric_limits<double>::infinity();
    const double downhill = curvature > 0 ? -slope / curvature : std::copysign(kMaxStep, -slope);
    const double step = std::clamp(downhill, -kMaxStep, kMaxStep);
    check.best_focal_factor = at * (1.0 + step);
    if (std::abs(step) < options.probe) break;
  }
  check.is_determined = check.relative_sigma <= options.max_relative_sigma;
  constexpr double kSigmas = 4.0;
  const double mismatch = std::abs(check.best_focal_factor - 1.0);
  check.is_contradicted = mismatch > options.max_mismatch && mismatch > kSigmas * check.relative_sigma;
  return check;
}

}  // namespace fabloop
