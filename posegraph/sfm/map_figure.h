// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "frontend/sequence/trajectory.h"
#include "posegraph/sfm/loop_link.h"
#include "posegraph/sfm/reconstruction.h"
#include "posegraph/sfm/surface_mesh.h"

namespace fabloop {

/// What the figure shows.
struct MapFigure {
  const Reconstruction& reconstruction;
  const Pose& ground_from_world;
  const GroundPicture& picture;
  const Trajectory& odometry;  ///< In any frame and scale; it is aligned to the result. May be empty: one panel then.
  const std::vector<LoopLink>& loops;
  const std::string& title;
};

/// Figure 4 of Glover et al. (ICRA 2012) for any map: on the left the odometry with the loops found (before), on the right the
/// textured map with the trajectory (after; with the loops where there is no odometry), at one scale, with scale bar and legend;
/// for print at full page width (BGR, 8 bit).
cv::Mat3b draw_map_figure(const MapFigure& figure);

/// Writes draw_map_figure() as PNG. Throws InputError when it cannot be written.
void write_map_figure(const std::filesystem::path& path, const MapFigure& figure);

}  // namespace fabloop
