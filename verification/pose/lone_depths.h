// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "frontend/geometry/pose.h"
#include "verification/pose/relative_pose.h"

namespace fabloop {

struct LoneDepthOptions {
  /// An inlier whose depth is less likely than this, relative to an accident's, is alone. Of real flights' inliers below one, one
  /// in eight is an accident; above it, one in some thousands.
  double min_likelihood_ratio = 1.0;
  double max_plane_error = 0.1;    ///< Relative to the depth, of points that tell the scene's main plane.
  double min_plane_share = 0.5;    ///< Of the inliers that such a plane holds; else it is none.
  double min_relief = 0.02;        ///< Least scatter of depths about the plane, relative.
  std::size_t num_neighbours = 6;  ///< Whose depths an inlier may share.
  double line_length_rad = 1.0;    ///< Of an epipolar line within the image, on which an accident lies anywhere.
  double max_share = 0.5;          ///< Of the inliers: more than these are not alone, but another part of the scene.
};

/// Inliers (indices of pairs, ascending) that are likelier accidents than true by where they lie along their epipolar lines: an
/// accident lies anywhere, a true one is about as deep as the scene's main plane or as its neighbours in the image. Where depths
/// are vague, for want of parallax, or scatter, none is alone that lies within their scatter. `max_error_rad` is that of the
/// inliers.
std::vector<std::size_t> lone_depths(std::span<const RayPair> pairs, const RelativePose& relative, double max_error_rad,
                                     const LoneDepthOptions& options = {});

/// What bends a pose.
struct BendingAccidents {
  std::vector<std::size_t> inliers;  ///< Indices of pairs, ascending; at least one.
  Pose match_from_query;  ///< As the inliers tell it that are not alone: unbent, but less certain than with all others.
};

/// The lone inliers that do not agree with the pose that the others tell without them; none where all do. One such accident apart
/// from the others bends a pose by many degrees, and lies as close to its epipolar line as any. A mast or a tree agrees, unless
/// the pose hinges on it: what the others tell is then all that is known.
std::optional<BendingAccidents> find_bending_accidents(std::span<const RayPair> pairs, const RelativePose& relative,
                                                       const RelativePoseOptions& pose_options,
                                                       const LoneDepthOptions& options = {});

}  // namespace fabloop
