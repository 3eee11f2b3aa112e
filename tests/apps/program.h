// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace fabloop::testing_support {

/// What the built program did.
struct ProgramResult {
  int exit_code = -1;  ///< -1: ended by a signal.
  std::string out;
  std::string err;
};

struct ProgramLimits {
  /// No file grows beyond it; a write that would fails (EFBIG), as it does on a full disk.
  std::optional<std::size_t> max_file_bytes{};
  /// The program is killed (SIGKILL: it cannot tidy up) as soon as this exists.
  std::filesystem::path kill_when_exists{};
  /// Called with each line of its output as it comes; meanwhile the program goes on.
  std::function<void(const std::string&)> on_line{};
};

/// Runs `fabloop ARGUMENTS...` to its end.
ProgramResult run_fabloop(const std::vector<std::string>& arguments, const ProgramLimits& limits = {});

/// Succeeds when the program refused its input as promised: exit code 1, and one line on stderr that starts with
/// "fabloop: " and names the culprit.
void expect_refused(const ProgramResult& result, const std::string& culprit);

/// Succeeds when there is nothing in the folder: no result, no part of one.
void expect_empty(const std::filesystem::path& folder);

/// What is in the folder, files and folders.
std::set<std::string> names_in(const std::filesystem::path& folder);

/// All of a file's bytes.
std::string bytes_of(const std::filesystem::path& path);

}  // namespace fabloop::testing_support
