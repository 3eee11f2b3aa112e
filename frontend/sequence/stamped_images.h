// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "frontend/progress.h"

namespace fabloop {

/// An image file and when it was taken.
struct StampedPath {
  std::filesystem::path path;
  std::int64_t time_ns = 0;
  bool is_time_known = true;  ///< Else the stamp only counts images, as names like 000012.jpg do.
};

/// The images of a sequence folder (itself or in `images/`) in order of time; stamps come from `frames.csv` or `track.csv`
/// (`filename,timestamp_s`), else from file names that are numbers of seconds or nanoseconds, else images are 1 s apart in the
/// order of their names. Throws InputError: folder missing or without images, a bad line, an image that is not there.
std::vector<StampedPath> list_stamped_images(const std::filesystem::path& folder, const Warn& warn = {});

/// What a sequence is called: the last part of its path.
std::string sequence_name(const std::filesystem::path& path);

}  // namespace fabloop
