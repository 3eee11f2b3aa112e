// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/program.h"

namespace fabloop::testing_support {

/// What a summary says, but for how long it took.
inline nlohmann::json summary_without_timings(const std::filesystem::path& path) {
  nlohmann::json summary = nlohmann::json::parse(bytes_of(path));
  EXPECT_EQ(summary.erase("timings"), 1U);
  summary.erase("peak_memory_mib");  // which those from images alone do not have
  return summary;
}

/// Succeeds when two run folders have the same files with the same bytes, timings apart.
inline void expect_same_runs(const std::filesystem::path& a, const std::filesystem::path& b) {
  ASSERT_EQ(names_in(a), names_in(b));
  for (const std::string& name : names_in(a)) {
    if (std::filesystem::is_directory(a / name)) {
      expect_same_runs(a / name, b / name);
    } else if (name == "summary.json") {
      EXPECT_EQ(summary_without_timings(a / name), summary_without_timings(b / name));
    } else if (name != "report.html") {  // it shows the timings
      EXPECT_TRUE(bytes_of(a / name) == bytes_of(b / name)) << name << " differs";
    }
  }
}

}  // namespace fabloop::testing_support
