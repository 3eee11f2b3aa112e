// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "frontend/sequence/trajectory.h"
#include "posegraph/pose_graph.h"
#include "posegraph/run/ledger_table.h"

namespace fabloop {

/// The map as it would be without a stage.
struct StageTrajectory {
  std::string name;  ///< "without loops", ...
  std::string note;  ///< What was solved.
  std::size_t num_loops = 0;
  Trajectory trajectory;
};

/// Solves a run's graph (`graph.g2o`) again: without any loop; with all loops that geometry proved, each believed (no
/// consistency, no back end); with the same under the robust loss. The edges of loops that were not accepted are made of the
/// ledger's poses and standard deviations. `times_ns` has the time of each frame. Throws InputError for ids beyond it.
std::vector<StageTrajectory> solve_without_stages(const PoseGraph& graph, const LedgerTable& ledger,
                                                  const std::vector<std::int64_t>& times_ns);

}  // namespace fabloop
