// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fabloop {

/// Where the sources under `root` break the house's rules, one line each (`path:line: what`), in order of path; empty when
/// nowhere. The rules: includes point left only and are full paths from the root, OpenGV and Ceres stay in their places, the
/// libraries do not print, every file has its licence head and every header its `#pragma once`, nothing is left to be done.
std::vector<std::string> structure_violations(const std::filesystem::path& root);

}  // namespace fabloop
