// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "frontend/recognition/recognition_folder.h"

namespace fabloop {

/// How surely the images were at new places: the first thing to look at in a map of elsewhere.
struct NewPlaceFigures {
  double mean_p_new = 0.0;
  std::size_t num_probably_new = 0;  ///< Images with p_new above one half.
};
NewPlaceFigures new_place_figures(const Recognition& recognition);

/// Writes every figure of a run as JSON. All of it is the same from run to run but for the object "timings".
void write_recognition_summary(const std::filesystem::path& path, const RecognitionReport& report);

}  // namespace fabloop
