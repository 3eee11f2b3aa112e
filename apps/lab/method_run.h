// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/lab/back_end_trial.h"
#include "apps/lab/earlier_flight.h"
#include "apps/lab/lab_cell.h"
#include "frontend/baselines/score_table.h"
#include "frontend/fabmap/ground_truth.h"
#include "frontend/fabmap/model.h"
#include "frontend/sequence/sequence.h"
#include "posegraph/describe_sequence.h"
#include "posegraph/evaluation/stage_evaluation.h"

namespace fabloop {

/// What one method and the stages after it made of a cell.
struct MethodResult {
  std::string name, label;
  /// Up to the consistency stage; whatever passed that has passed 4 stages. Loops to an earlier flight have then passed all 5: no
  /// back end looks at them.
  JudgedRun run;
  std::vector<BackEndTrial> back_ends;
};

/// A cell's data, looked at once for all methods.
struct CellData {
  Sequence sequence;
  std::vector<DescribedFrame> frames;  ///< Those that can be used; the places of all methods, in this order.
  EarlierFlight earlier;               ///< Its frames are places before those.
  KeyframeMap earlier_map;             ///< The same as the loop closer takes them; empty where no pair is verified.
  Model model;
  GroundTruth places;
  LoopTruth loops;
  Trajectory reference;
  std::vector<std::int64_t> frame_times_ns;
};

/// Judges a method's scores, and, where the description verifies, has geometry, consistency and back ends look at the best ones
/// of each query. `scores` has rows for the sequence's frames alone; these and places are numbered as EarlierFlight says.
/// `scratch` is a folder for files in between. Throws InputError as its parts do.
MethodResult run_method(const LabMethod& method, const ScoreTable& scores, const CellData& data, const LabCell& cell,
                        const LabDescription& description, const std::filesystem::path& scratch, int num_threads);

/// The run as the stage of a back end sees it: loops that it kept have passed 5 stages, and injected ones are among them.
JudgedRun with_back_end(const JudgedRun& run, const BackEndTrial& trial);

/// One run of several with the same method and settings, for figures over all of them.
JudgedRun pooled(const std::vector<const JudgedRun*>& runs);

}  // namespace fabloop
