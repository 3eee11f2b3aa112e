// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "frontend/output_file.h"
#include "frontend/sequence/sequence.h"
#include "frontend/sequence/trajectory.h"
#include "posegraph/sfm/reconstruct.h"

namespace fabloop {

/// Writes the points in colour (binary PLY: float x y z, uchar red green blue).
void write_points_ply(const std::filesystem::path& path, const Reconstruction& reconstruction);

/// Writes the public run folder of a map made from images alone: the same files as write_run_folder() but for what only odometry
/// has. It appears under its name only when it is complete. The same result gives the same bytes, but for the timings in
/// summary.json. Throws InputError when it exists (unless `Replace`) or cannot be written. Work that the reconstruction kept in
/// `options.state_folder` is removed once the folder is there.
void write_reconstruction_folder(const std::filesystem::path& path, const Sequence& sequence, const Reconstructed& result,
                                 const ReconstructOptions& options,
                                 OutputFolder::IfExists if_exists = OutputFolder::IfExists::Refuse);

}  // namespace fabloop
