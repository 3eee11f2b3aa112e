// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/report_data.h"

namespace fabloop::apps {

/// The page with its title and data filled in.
std::string report_page(const std::string& title, const nlohmann::ordered_json& data);

/// Writes the page, which needs nothing but itself. Throws InputError naming the file that is missing, bad or cannot be written.
void write_report(const std::filesystem::path& path, const ReportInput& input);

}  // namespace fabloop::apps
