// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "frontend/fabmap/ground_truth.h"
#include "frontend/recognition/observed_images.h"

namespace fabloop {

struct RecognitionTruthOptions {
  PoseRules poses{};                    ///< For truths that are poses.
  PairRules pairs{};                    ///< For truths that are pairs.csv.
  std::size_t exclusion_window = 10;    ///< Within one sequence; see ExclusionWindow.
  double max_time_difference_s = 0.01;  ///< Between an image and its pose.
};

/// Whether a file is a loop matrix: `.npy`, or text whose first line of content is one of 0 and 1.
bool is_loop_matrix(const std::filesystem::path& path);

/// The ground truth of a sequence recognised in itself. `path` is a folder (its `pairs.csv`, else its `reference.tum`), a
/// `pairs.csv`, a loop matrix (see read_loop_matrix), or poses in TUM form. Throws InputError when it is none of them, or when no
/// pose is near an image in time.
GroundTruth read_truth(const std::filesystem::path& path, const std::vector<ObservedImage>& images,
                       const RecognitionTruthOptions& options = {});

/// The ground truth of queries in a map: `path` is a loop matrix (query x map), or the queries' poses, as a TUM file or a folder
/// with `reference.tum`; then `map_path` holds the map's, in the same world frame. Throws InputError likewise.
GroundTruth read_truth_in_map(const std::filesystem::path& path, const std::vector<ObservedImage>& queries,
                              const std::filesystem::path& map_path, const std::vector<ObservedImage>& map,
                              const RecognitionTruthOptions& options = {});

}  // namespace fabloop
