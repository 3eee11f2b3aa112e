// SPDX-License-Identifier: BSD-3-Clause
#include "apps/run_files.h"

#include <fstream>

#include "frontend/csv_lines.h"
#include "frontend/error.h"

namespace fabloop::apps {

nlohmann::ordered_json find_summary(const std::filesystem::path& run) {
  std::ifstream file(run / "summary.json");
  auto summary = nlohmann::ordered_json::parse(file, nullptr, false);
  return summary.is_object() ? summary : nlohmann::ordered_json(nullptr);
}

RunKind run_kind(const nlohmann::ordered_json& summary) {
  if (!summary.is_object()) return {};
  return {summary.value("method", "") == "structure from motion", summary.value("unit", "") != "arbitrary"};
}

nlohmann::ordered_json read_summary(const std::filesystem::path& run) {
  auto summary = find_summary(run);
  if (summary.is_null()) {
    throw InputError((run / "summary.json").string() + ": is missing or no JSON; give the folder that `fabloop map` wrote");
  }
  return summary;
}

std::vector<std::string> read_frame_names(const std::filesystem::path& run) {
  std::vector<std::string> names;
  for_each_csv_line(run / "frames.csv", [&](const CsvFields& fields, const CsvFail&) { names.push_back(fields.front()); });
  return names;
}

}  // namespace fabloop::apps
