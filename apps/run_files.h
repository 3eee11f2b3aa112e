// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace fabloop::apps {

/// A run folder's summary.json; null where it is missing or no JSON object.
nlohmann::ordered_json find_summary(const std::filesystem::path& run);

/// The same; throws InputError instead.
nlohmann::ordered_json read_summary(const std::filesystem::path& run);

/// How a run came about.
struct RunKind {
  bool is_from_images = false;  ///< Structure from motion: graph.g2o says what the map says, and cannot be solved without stages.
  bool has_unit = true;         ///< Its unit of length is the metre, not an arbitrary one.
};

/// By its summary; as with odometry where that is null.
RunKind run_kind(const nlohmann::ordered_json& summary);

/// The file names of a run's frames, in order: the first column of its frames.csv. Throws InputError as for_each_csv_line() does.
std::vector<std::string> read_frame_names(const std::filesystem::path& run);

}  // namespace fabloop::apps
