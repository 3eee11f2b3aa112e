// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "frontend/sequence/trajectory.h"
#include "posegraph/evaluation/trajectory_error.h"

namespace fabloop::apps {

/// The trajectories of a run and its points in one world, as the page draws them: the reference's where it is known (moved there
/// as `alignment` says), else the run's own. `up` is the page's vertical.
nlohmann::ordered_json map_data(const std::filesystem::path& run, const Trajectory& reference,
                                const std::vector<std::int64_t>& frame_times_ns, Alignment alignment);

}  // namespace fabloop::apps
