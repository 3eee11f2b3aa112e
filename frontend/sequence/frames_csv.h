// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace fabloop {

/// One line of frames.csv.
struct StampedImage {
  std::string filename;
  std::int64_t time_ns = 0;
  int line = 0;  ///< Where it stands in the file, from 1: for messages.
};

/// Reads lines `filename,timestamp_s` (further columns are ignored). `#` comments, empty lines, a header line that starts with
/// `filename`, Windows line ends and spaces around the columns are accepted. Throws InputError naming file and line for
/// anything else and for stamps that do not ascend, and when there is no line at all.
std::vector<StampedImage> read_frames_csv(const std::filesystem::path& path);

}  // namespace fabloop
