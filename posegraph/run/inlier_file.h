// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "posegraph/mapper.h"

namespace fabloop {

/// Where two images show the same, by their pixels.
struct PixelPair {
  cv::Point2f query, match;
};

/// The matches that agree with the pose of each hypothesis, by (query, match): frame positions as in `loops.csv`.
using InlierPixels = std::map<std::pair<std::size_t, std::size_t>, std::vector<PixelPair>>;

/// Writes them for the hypotheses within the sequence: a NumPy matrix (float32) with a row an inlier: query, match, x_query,
/// y_query, x_match, y_match [px, pixel centres at integers], in the ledger's order.
void write_inliers(const std::filesystem::path& path, const Map& map);

/// The same of pixels that are at hand, in ascending order of query and match.
void write_inliers(const std::filesystem::path& path, const InlierPixels& inliers);

/// Reads it. Throws InputError naming the file when it is missing or something else.
InlierPixels read_inliers(const std::filesystem::path& path);

}  // namespace fabloop
