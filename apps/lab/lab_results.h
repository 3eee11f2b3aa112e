// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/lab/cell_run.h"
#include "apps/lab/lab_cell.h"
#include "apps/lab/lab_description.h"
#include "posegraph/evaluation/stage_evaluation.h"

namespace fabloop {

/// A cell and what came of it.
struct FinishedCell {
  LabCell cell;
  CellResult result;
};

/// One stage's figures.
struct StageRow {
  std::string stage;            ///< "geometry", ...; for back ends "back end: NAME".
  StageResult result;           ///< Of back ends with injected loops, which have no score: without ranking and calibration.
  std::optional<double> ate_m;  ///< Of back ends: their map's error. Pooled: the mean over the cells.
};

/// What a method came to, in one cell or in all cells of a group.
struct MethodRows {
  std::string data;
  std::vector<std::pair<std::string, double>> swept;
  std::string group;                  ///< LabCell::group().
  std::optional<std::uint64_t> seed;  ///< None: pooled over the group's seeds.
  std::size_t num_cells = 1;
  std::size_t num_queries = 0;
  std::string method, label;
  std::optional<double> odometry_ate_m;  ///< Pooled: the mean.
  std::vector<StageRow> stages;
  std::string recipe;
};

/// The figures of every cell and method, and pooled ones, whose queries are those of all seeds together: bootstrap intervals and
/// curves are over all of them. Cells must come as cells_of() orders them.
struct LabResults {
  std::vector<MethodRows> cells, pooled;
};
LabResults evaluate_cells(const std::vector<FinishedCell>& cells, const LabDescription& description, int num_threads);

}  // namespace fabloop
