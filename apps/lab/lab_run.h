// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "apps/lab/lab_description.h"
#include "frontend/progress.h"
#include "frontend/work_state.h"

namespace fabloop {

struct LabRunOptions {
  std::filesystem::path data_root{};  ///< What folders of sequences are relative to. Empty: the description's folder.
  int num_jobs = 0;                   ///< Cells run at the same time; 0: one a hardware thread. Results do not depend on it.
  int num_threads = 0;                ///< Of all cells together, at least one each; 0: all. Results do not depend on it.
  WorkState::IfFound if_found = WorkState::IfFound::Resume;  ///< Discard: all cells that are there are removed and made anew.
  Warn warn{};                                               ///< Told of cells of another description.
  Progress progress{};
};

/// How an experiment went.
struct LabRunReport {
  std::size_t num_cells = 0;
  std::size_t num_there = 0;  ///< Of them, made by an earlier run.
  std::size_t num_stale = 0;  ///< Files of cells that the description does not have; they are left alone.
};

/// Runs an experiment into a folder: each finished cell is one file in `cells/`, named by the checksum of what it depends on,
/// so that a run that was killed goes on where it was, and cells that a changed description, sequence or version (see
/// cell_text()) changes are made anew; a program built anew under the same version takes the cells that are there. Then writes
/// `results.csv`, `results.json`, `table.md`, figures (in place of earlier ones) and a copy of the description. The same
/// description gives the same bytes, in one go or many. Throws InputError when the folder holds something else or another run is
/// at work in it, and as run_cell() does.
LabRunReport run_lab(const LabDescription& description, const std::filesystem::path& out, const LabRunOptions& options = {});

}  // namespace fabloop
