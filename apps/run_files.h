// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace fabloop::apps {

/// A run folder's summary.json. Throws InputError where it is missing or no JSON object.
nlohmann::ordered_json read_summary(const std::filesystem::path& run);

/// The file names of a run's frames, in order: the first column of its frames.csv. Throws InputError as for_each_csv_line() does.
std::vector<std::string> read_frame_names(const std::filesystem::path& run);

}  // namespace fabloop::apps
