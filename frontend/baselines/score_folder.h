// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "frontend/baselines/score_table.h"
#include "frontend/output_file.h"

namespace fabloop {

/// What was scored, by what, and how well. Keeps references: for the length of a call.
struct ScoreReport {
  std::string method;         ///< As the option names it.
  const ScoreTable& table;    ///< With the method's label.
  std::string sequence, map;  ///< Names; `map` is empty where the sequence was looked up in itself.
  std::size_t num_damaged = 0;
  std::size_t num_recent_excluded = 0;
  std::size_t max_matches = 10;
  const PrecisionRecall* judged = nullptr;  ///< None: there was no truth.
};

/// Writes the files of a run by a method other than FAB-MAP, and lets the folder appear: `scores.npy` (row a query, column a
/// place; NaN where there is none), `hypotheses.csv` (`query,rank,match,score`, which read_scores() reads), `summary.json`, and
/// with a truth `precision_recall.csv` and `.png`. Throws InputError when they cannot be written.
void write_scores(OutputFolder& folder, const ScoreReport& report);

}  // namespace fabloop
