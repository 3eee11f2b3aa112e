// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <vector>

#include "apps/run_files.h"
#include "posegraph/evaluation/stage_evaluation.h"

namespace fabloop::apps {

/// What each stage makes of a run of that kind: structure from motion tries all its pairs alike, so of them nothing is said of
/// ranking and calibration.
StageEvaluation evaluate_stages(const JudgedRun& run, const RunKind& kind, const StageOptions& options);

/// All figures, curves and diagrams.
nlohmann::ordered_json stages_json(const StageEvaluation& evaluation);

/// A table with a line a stage, and the recipe.
void print_stages(std::ostream& out, const StageEvaluation& evaluation);

/// Writes `stages.csv` (a line a stage), `precision_recall.csv` and `calibration.csv` (a line a point, a line a bin).
void write_stage_tables(const std::filesystem::path& folder, const StageEvaluation& evaluation);

}  // namespace fabloop::apps
