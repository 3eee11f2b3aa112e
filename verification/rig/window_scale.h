// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "verification/rig/keyframe_window.h"
#include "verification/verifier.h"

namespace fabloop {

/// The pose with its length of a loop that was accepted without one, from a short window of views around either side as two rigs
/// (verify_windows()). The windows' frames are the cameras of the loop's query and match, their unit is the odometry's. None
/// where they tell no length, or a pose too vague for a loop (VerifierOptions::max_distance_sigma, max_translation_sigma,
/// max_rotation_sigma); where their inliers may be an accident; and where rotation or direction are not the pair's: then the
/// windows are bent, and the pair stands. `p_true` stays the pair's.
std::optional<Verification> scale_by_windows(const Verification& pair, std::span<const WindowView> query,
                                             std::span<const WindowView> match, const WindowOptions& window_options,
                                             const VerifierOptions& options);

}  // namespace fabloop
