// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "frontend/output_file.h"
#include "frontend/sequence/sequence.h"
#include "posegraph/evaluation/trajectory_error.h"
#include "posegraph/map_sequence.h"

namespace fabloop {

/// Errors against the reference after SE(3) alignment; none without a reference.
struct RunErrors {
  std::optional<AbsoluteTrajectoryError> odometry, online, final;
};

RunErrors run_errors(const Sequence& sequence, const Map& map);

/// Counts of what became of the hypotheses.
struct LoopCounts {
  std::size_t num_hypotheses = 0;
  std::size_t num_accepted = 0;
  std::size_t num_with_scale = 0;    ///< Of the accepted.
  std::size_t num_into_earlier = 0;  ///< Of the accepted: that lead into the earlier map.
};

LoopCounts count_loops(const Map& map);

/// Writes the public run folder: summary.json, trajectory.tum, trajectory_online.tum, trajectory_odometry.tum, graph.g2o,
/// loops.csv, frames.csv (`filename,timestamp_s` of every frame of the sequence: what `query` and `match` count), inliers.npy,
/// points.ply, map.png. It appears under its name only when it is complete. The same map gives the same bytes,
/// but for the timings in summary.json. Throws InputError when it exists (unless `Replace`) or cannot be written.
void write_run_folder(const std::filesystem::path& path, const Sequence& sequence, const SequenceMap& result,
                      const MapSequenceOptions& options, OutputFolder::IfExists if_exists = OutputFolder::IfExists::Refuse);

/// The table of every hypothesis and its verdict: `query,match,probability,verdict,matches,inliers,has_scale,tx,...,qw`, then
/// the figures of the gates.
void write_loops_csv(const std::filesystem::path& path, const Map& map);

/// Every frame of a sequence, in its order: `filename,timestamp_s`.
void write_frames_csv(const std::filesystem::path& path, const Sequence& sequence);

/// All triangulated points in the world, grey as in their image (binary PLY: float x y z, uchar red green blue).
void write_points_ply(const std::filesystem::path& path, const Map& map);

}  // namespace fabloop
