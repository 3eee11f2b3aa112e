// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace fabloop::apps {

/// The head of the README's table of results (Markdown).
std::string results_head();

/// One row: what `fabloop evaluate` found about a run, and the run's own counts and timings. Throws InputError when the run
/// has no summary.json.
std::string results_row(const std::filesystem::path& run, const nlohmann::ordered_json& evaluation);

}  // namespace fabloop::apps
