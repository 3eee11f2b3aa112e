// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "frontend/fabmap/ground_truth.h"
#include "frontend/recognition/recognition_truth.h"
#include "frontend/sequence/trajectory.h"
#include "posegraph/evaluation/loop_evaluation.h"
#include "posegraph/evaluation/loop_truth.h"

namespace fabloop::apps {

/// Where a run and its truth are, and how truth is told.
struct TruthArguments {
  std::filesystem::path run;
  std::filesystem::path truth;   ///< A sequence folder, a reference in TUM form, a pairs.csv or a loop matrix.
  std::filesystem::path frames;  ///< Times of the frames; empty: the sequence folder's, else the run's.
  RecognitionTruthOptions places;
};

/// What a run is judged against.
struct RunTruth {
  std::vector<std::int64_t> frame_times_ns;
  Trajectory reference;  ///< Empty with a loop matrix.
  LoopTruth loops;
  GroundTruth places;
};

/// The reference's file; none with a loop matrix.
std::optional<std::filesystem::path> reference_path(const TruthArguments& arguments);

/// Where no pairs are known: from where on pairs are false, for places and for loops alike; see false_radius_m().
void set_false_radius(TruthArguments& truth, LoopEvaluationOptions& loops, std::optional<double> wanted_m = {});

/// Reads it. Throws InputError naming the file that is missing or bad.
RunTruth read_run_truth(const TruthArguments& arguments);

}  // namespace fabloop::apps
