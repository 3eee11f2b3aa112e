// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/apps/program.h"

namespace fabloop::testing_support {

/// `fabloop map` of a sequence with the odometry in its folder, with so few features that it takes a second.
inline std::vector<std::string> map_command(const std::filesystem::path& sequence, const std::filesystem::path& out,
                                            const std::vector<std::string>& more = {}) {
  std::vector<std::string> command = {"map",    sequence.string(), "--odometry",   (sequence / "odometry.tum").string(),
                                      "--out",  out.string(),      "--hypotheses", "3",
                                      "--quiet"};
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

/// `fabloop map` of a sequence from its images alone, with so few features that it takes seconds.
inline std::vector<std::string> images_command(const std::filesystem::path& sequence, const std::filesystem::path& out,
                                               const std::vector<std::string>& more = {}) {
  std::vector<std::string> command = {"map", sequence.string(), "--out", out.string(), "--max-features", "300"};
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

/// What a report's page holds.
inline nlohmann::json data_of(const std::string& page) {
  const std::string begin = "<script id=\"data\" type=\"application/json\">";
  const std::size_t first = page.find(begin) + begin.size();
  return nlohmann::json::parse(page.substr(first, page.find("</script>", first) - first));
}

/// For sequences that are mapped without a model.
inline const std::vector<std::string> kFewFeatures = {"--max-features", "300"};

}  // namespace fabloop::testing_support
