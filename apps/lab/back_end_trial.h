// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/lab/lab_description.h"
#include "frontend/sequence/trajectory.h"
#include "posegraph/evaluation/loop_evaluation.h"
#include "posegraph/evaluation/loop_truth.h"
#include "posegraph/evaluation/stage_evaluation.h"
#include "posegraph/mapper.h"

namespace fabloop {

/// A loop that a back end is given: two frames, and whether it was kept.
struct TriedLoop {
  std::size_t query = 0, match = 0;  ///< Positions in the sequence.
  bool is_kept = false;
  bool is_injected = false;                  ///< Added by the experiment.
  MatchTruth truth = MatchTruth::NotJudged;  ///< Of injected ones: false, unless the reference proves the pose right.
};

/// What a back end made of a map's loops.
struct BackEndTrial {
  std::string name;
  std::vector<TriedLoop> loops;  ///< In the order of the graph's edges, injected ones last.
  std::optional<double> ate_m;   ///< Of the solved graph; none where it is not defined.
};

/// What back ends are tried on.
struct BackEndProblem {
  const Map& map;  ///< Mapped so that no loop was withdrawn.
  const LoopTruth& truth;
  const Trajectory& reference;
  const std::vector<std::int64_t>& frame_times_ns;
  LoopEvaluationOptions evaluation;
  MapperOptions mapper;  ///< How "map" decides.
  LabSettings settings;  ///< False loops to add, and the probability of robust back ends.
};

/// Sets the vertices where odometry alone leads from the first (or the fixed) ones: no loop has a part in it, nor have the edges
/// to neighbours, which have no scale.
void start_from_odometry(PoseGraph& graph);

/// Adds the false loops that the settings ask for (shaped after the map's own loops; none where it has none), starts from where
/// odometry leads (start_from_odometry()), and has each back end sort it out. Throws InputError as robust_optimize() does.
std::vector<BackEndTrial> try_back_ends(const std::vector<LabBackEnd>& back_ends, const BackEndProblem& problem);

/// ATE of a map's odometry; none where it is not defined.
std::optional<double> ate_of(const Trajectory& estimate, const Trajectory& reference);

}  // namespace fabloop
