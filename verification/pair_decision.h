// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "verification/pose/pose_choice.h"
#include "verification/pose/relative_pose.h"
#include "verification/verifier.h"
#include "verification/view.h"

namespace fabloop {

/// The diagonal field of view, lens distortion apart.
double field_of_view_rad(const Camera& camera);

/// Without parallax: the pose from known points, refined on rays and points together. Sets the pose and its figures, and the
/// verdict: `Accepted`, `NoParallax` or `ScaleDisagrees`.
void decide_by_points(const View& query, const View& match, const std::vector<Match>& matches, const std::vector<RayPair>& pairs,
                      const RelativePoseOptions& pose_options, const VerifierOptions& options, Verification& result);

/// With parallax: rotation and direction from the rays, the length from the points where they tell one. Sets the pose and its
/// figures, and the verdict: `Accepted`, `ScaleDisagrees` or `PoorlyConstrained`.
void decide_by_rays(std::span<const RayPair> pairs, const PoseCandidate& chosen, const VerifierOptions& options,
                    Verification& result);

}  // namespace fabloop
