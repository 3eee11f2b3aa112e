// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "frontend/sequence/sequence.h"
#include "posegraph/sfm/reconstruct.h"

namespace fabloop {

/// Writes every figure of a reconstruction as JSON. All of it is the same from run to run but for the object "timings".
void write_reconstruction_summary(const std::filesystem::path& path, const Sequence& sequence, const Reconstructed& result,
                                  const ReconstructOptions& options);

}  // namespace fabloop
