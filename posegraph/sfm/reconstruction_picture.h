// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "posegraph/sfm/reconstruction.h"

namespace fabloop {

/// The reconstruction from above: its points in their colours, the cameras' path, the loops (pairs of positions in
/// Reconstruction::images) over it, and a scale bar where the unit is known (BGR, 8 bit). Above is where the cameras are seen
/// from the points, so that the picture is turned as a photograph from there.
cv::Mat draw_reconstruction(const Reconstruction& reconstruction, const std::vector<std::pair<std::size_t, std::size_t>>& loops);

}  // namespace fabloop
