// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "posegraph/pose_graph.h"
#include "posegraph/run/inlier_file.h"
#include "posegraph/sfm/reconstruct.h"
#include "verification/loop_event.h"

namespace fabloop {

struct ReconstructionGraphOptions {
  std::size_t num_neighbours = 10;     ///< Pairs further apart than so many frames are loops.
  std::size_t min_shared_points = 15;  ///< Points that both must see in the result for a pair to count as proven by it.
};

/// What the result says of two images that share points.
struct SharedView {
  std::size_t query = 0, match = 0;  ///< Positions in Reconstruction::images; query after match.
  std::size_t num_shared_points = 0;
  Pose match_from_query;
  double rms_error_px = 0;  ///< Of the shared points in the query.
  /// Of (translation, rotation) of match_from_query in the query's axes: the query resected against the shared points, which are
  /// taken as known.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
};

/// The proven pairs that share enough points in the result, in ascending order.
std::vector<SharedView> shared_views(const Reconstructed& result, const ReconstructionGraphOptions& options = {});

/// The images as vertices (ids are frames), the steps from image to image and the loops as edges.
PoseGraph reconstruction_graph(const Reconstructed& result, const ReconstructionGraphOptions& options = {});

/// Where the images of each proven loop show the same points.
InlierPixels shared_pixels(const Reconstructed& result, const ReconstructionGraphOptions& options = {});

/// The pairs beyond the neighbours as a ledger: accepted where the result bears them out. In arbitrary units they have no scale.
std::vector<LoopEvent> reconstruction_loops(const Reconstructed& result, const ReconstructionGraphOptions& options = {});

}  // namespace fabloop
