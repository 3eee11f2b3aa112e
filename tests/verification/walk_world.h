// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "frontend/fabmap/model.h"
#include "frontend/features/features.h"
#include "frontend/geometry/pose.h"
#include "verification/keyframe.h"
#include "verification/loop_closer.h"

namespace fabloop::testing_support {

struct WalkOptions {
  int num_landmarks = 4000;
  std::size_t num_frames = 36;  ///< Of one lap.
  std::size_t num_again = 6;    ///< The first frames of the lap once more, from a little aside.
  double noise_px = 0.3;
  std::uint64_t seed = 1;
};

/// A walk round a circle above random landmarks, each with a descriptor of its own, whose start is seen again at its end.
struct Walk {
  std::vector<Pose> world_from_camera;
  std::vector<Features> features;                                             ///< One a frame.
  std::vector<std::vector<std::optional<Eigen::Vector3d>>> points_in_camera;  ///< The true point of each feature.
  Model model;                                                                ///< Its words were trained on the walk itself.
};

Walk make_walk(const WalkOptions& options = {});

/// Frame i of a walk as a keyframe with the true odometry. Hosts number keyframes as they like: this one from 100, a second each.
Keyframe keyframe_of(const Walk& walk, std::size_t i);

/// What a loop closer says of every keyframe of a walk.
std::vector<LoopEvent> close_loops(const Walk& walk, const LoopCloserOptions& options);

/// A loop closer's for a walk: two hypotheses a keyframe, none among the last ten, one thread.
LoopCloserOptions walk_options();

}  // namespace fabloop::testing_support
