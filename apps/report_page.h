// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "apps/report_data.h"

namespace fabloop::apps {

/// Writes the page, which needs nothing but itself. Throws InputError naming the file that is missing, bad or cannot be written.
void write_report(const std::filesystem::path& path, const ReportInput& input);

}  // namespace fabloop::apps
