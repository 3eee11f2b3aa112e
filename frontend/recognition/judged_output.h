// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "frontend/fabmap/precision_recall.h"

namespace fabloop {

/// As many digits as it takes to get the same number back.
std::string exact_text(double value);

/// Writes `threshold_NAME,precision,recall` below the recipe; `score_name` says what is thresholded: "log_odds", "score".
void write_precision_recall(const std::filesystem::path& path, const PrecisionRecall& judged, const std::string& score_name);

/// Every figure; null for nothing judged.
nlohmann::ordered_json judged_json(const PrecisionRecall* judged, const std::string& score_name);

}  // namespace fabloop
