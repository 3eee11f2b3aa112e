// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "apps/lab/lab_cell.h"
#include "apps/lab/lab_description.h"
#include "apps/lab/method_run.h"
#include "data/sequence_trouble.h"

namespace fabloop {

/// All that came of a cell. It holds no times, so that the same cell gives the same bytes.
struct CellResult {
  std::size_t num_frames = 0;            ///< That could be used.
  double aliased_share = 0.0;            ///< Of the ground, as it came out.
  TroubledSequence trouble;              ///< What went wrong; all zero where nothing was to.
  std::optional<double> odometry_ate_m;  ///< None without odometry or reference.
  std::vector<MethodResult> methods;     ///< In the order of the description.
};

/// Makes the cell's data in `scratch` (an empty folder, which the caller removes), and runs every method on them. With a number
/// of threads (0: all) the result does not change. Throws InputError as its parts do.
CellResult run_cell(const LabCell& cell, const LabDescription& description, const std::filesystem::path& scratch,
                    int num_threads);

}  // namespace fabloop
