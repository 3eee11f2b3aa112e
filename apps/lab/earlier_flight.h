// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "frontend/baselines/score_table.h"
#include "frontend/fabmap/model.h"
#include "frontend/features/feature_options.h"
#include "frontend/sequence/sequence.h"
#include "posegraph/describe_sequence.h"
#include "posegraph/evaluation/stage_evaluation.h"
#include "posegraph/run/ledger_table.h"
#include "verification/map/keyframe_map.h"

namespace fabloop {

/// A flight over another place, which is in the map before the one that is judged. No frames: there is none.
///
/// Frames of both are numbered through, those of the earlier flight first.
struct EarlierFlight {
  Sequence sequence;
  std::vector<DescribedFrame> frames;  ///< Those that can be mapped: places of all methods, before the judged flight's.

  std::size_t num_frames() const { return sequence.frames.size(); }  ///< What the judged flight's numbers begin with.
};

/// Reads and describes it. An empty folder name gives none. Throws InputError when it has no odometry or fewer than two frames.
EarlierFlight look_at_earlier(const std::filesystem::path& folder, const FeatureOptions& features, int num_threads);

/// Its keyframes, their features with depths; its own loops are not looked for.
KeyframeMap keyframes_of(const EarlierFlight& earlier, const Model& model, int num_threads);

/// The `top` best places of each query among those of the earlier flight, and as many of its own flight, as LoopCloser takes them
/// (HypothesesOptions::max_hypotheses). `scores` has rows for the queries of the judged flight alone.
std::vector<ScoredQuery> best_of_both_flights(const ScoreTable& scores, std::size_t num_earlier_places, std::size_t top);

/// A run of the judged flight: `ledger` has all rows, `judged` is what came of those within the flight. Adds the others, which
/// are all false, as each query's pairs with all places of the earlier flight are, and numbers the frames of both flights
/// through.
JudgedRun with_pairs_across(JudgedRun judged, const LedgerTable& ledger, const EarlierFlight& earlier);

}  // namespace fabloop
