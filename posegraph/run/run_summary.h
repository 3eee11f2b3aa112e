// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "frontend/sequence/sequence.h"
#include "posegraph/map_sequence.h"

namespace fabloop {

/// Writes every figure of a run as JSON. All of it is the same from run to run but for "timings" and
/// "peak_memory_mib".
void write_run_summary(const std::filesystem::path& path, const Sequence& sequence, const SequenceMap& result,
                       const MapSequenceOptions& options);

}  // namespace fabloop
