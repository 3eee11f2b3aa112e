// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "posegraph/sfm/segment.h"

namespace fabloop {

/// What positions of the cameras are used for.
enum class PositionUse {
  Witness,  ///< Only to say how far the map is off them: the map shows what images alone can do.
  Align,    ///< To give the map its unit, its place and its attitude; its shape is the images'.
  Prior,    ///< Also in the last bundle adjustment: takes out slow bends where positions are good.
};

struct GeoreferenceOptions {
  double sigma_m = 3.0;           ///< Standard deviation of the positions along each axis. Less for RTK.
  double min_inlier_share = 0.5;  ///< Of the positions, how many must agree with one similarity.
  /// Least width of the cameras' centres across their longest axis, as a share of their extent along it: positions on a line
  /// leave the map free to turn about it.
  double min_width = 0.03;
  std::uint64_t seed = 1;
};

/// How a segment's world lies in that of known positions: x_known = scale * rotation * x + translation.
struct Georeference {
  double scale = 1;
  Pose known_from_world;
  std::size_t num_positions = 0;  ///< Of placed views.
  std::size_t num_inliers = 0;
  double rms_m = 0;     ///< Distance of the inliers, three axes together.
  double median_m = 0;  ///< Distance of all.
};

/// A georeference, or why there is none.
struct GeoreferenceResult {
  std::optional<Georeference> found;
  std::string why_not;
};

/// Aligns the cameras' centres with known positions (one a view, where known), robustly.
GeoreferenceResult georeference(const Segment& segment, const std::vector<std::optional<Eigen::Vector3d>>& known_positions,
                                const GeoreferenceOptions& options = {});

/// Moves a segment's world.
void move_segment(Segment& segment, double scale, const Pose& new_from_old);

}  // namespace fabloop
