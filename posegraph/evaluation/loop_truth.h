// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "frontend/fabmap/pair_truth.h"
#include "frontend/geometry/pose.h"
#include "frontend/sequence/trajectory.h"

namespace fabloop {

/// A line of a run's `loops.csv`: a hypothesis and what became of it.
struct LoopRecord {
  std::size_t query = 0;  ///< 0-based position of the frame in its sequence.
  std::size_t match = 0;  ///< As `query`.
  std::string verdict;    ///< Name of the enumerator: "Accepted", ...
  bool has_scale = false;
  std::optional<Pose> match_from_query;  ///< Where the line has one. Without scale only the translation's direction counts.

  bool accepted() const;
};

/// What loops are judged against.
struct LoopTruth {
  std::vector<std::optional<Pose>> world_from_camera;  ///< Reference pose of each frame, where known.
  /// Pairs (i, j), i < j, by frame positions; an absent pair has no overlap. None: pairs are judged by their poses alone.
  std::optional<PairTruths> pairs;
};

/// Reads `loops.csv`: columns by the names in its head line, in any order; the pose may be empty where nothing was accepted.
/// Lines whose `match_session` is not their `session` are left out: their match is no frame of this sequence. Throws InputError
/// naming file and line for a missing column, a line that does not fit, an accepted line without a pose.
std::vector<LoopRecord> read_loops(const std::filesystem::path& path);

/// Reads lines `filename,timestamp_s` (`frames.csv`, `track.csv`): the time of each frame [ns], in the order of the lines.
/// Throws InputError naming file and line.
std::vector<std::int64_t> read_frame_times(const std::filesystem::path& path);

/// The truth of a sequence folder: `reference.tum`, the frames of `frames.csv` or `track.csv`, and `pairs.csv` where there is
/// one. Throws InputError naming the file that is missing or bad.
LoopTruth read_loop_truth(const std::filesystem::path& sequence_folder, double max_time_difference_s = 0.01);

/// The reference's pose at each frame's time, within `max_time_difference_s`.
std::vector<std::optional<Pose>> reference_poses(const std::vector<std::int64_t>& frame_times_ns, const Trajectory& reference,
                                                 double max_time_difference_s = 0.01);

}  // namespace fabloop
