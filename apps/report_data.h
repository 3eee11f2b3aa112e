// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/run_truth.h"
#include "posegraph/evaluation/loop_evaluation.h"
#include "posegraph/evaluation/stage_evaluation.h"

namespace fabloop::apps {

/// What a report is made of.
struct ReportInput {
  TruthArguments truth;          ///< The run, and the truth where there is one.
  std::filesystem::path images;  ///< Folder with the images of frames.csv; empty: no pictures.
  LoopEvaluationOptions loops;
  StageOptions stages;
  int num_threads = 0;  ///< 0: all. The result does not depend on it.
};

/// Everything that the page shows, read from a run folder. Throws InputError naming the file that is missing or bad.
nlohmann::ordered_json report_data(const ReportInput& input);

}  // namespace fabloop::apps
