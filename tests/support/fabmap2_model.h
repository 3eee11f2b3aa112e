// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <utility>
#include <vector>

#include "frontend/fabmap/chow_liu_tree.h"
#include "frontend/fabmap/observation.h"

namespace fabloop::testing {

/// The FAB-MAP 2.0 authors' own tree and some of their images.
struct FabMap2Model {
  ChowLiuTree tree;                             ///< 10,000 words.
  std::map<int, Observation> observations;      ///< By index of the image in their sequence.
  std::vector<std::pair<int, int>> true_pairs;  ///< Query, match.
};

/// Reads `chow_liu_tree.csv`, `bow.csv` and `gt_pairs.csv` of a folder. Throws InputError naming file and line for bad lines.
FabMap2Model read_fabmap2(const std::filesystem::path& folder);

}  // namespace fabloop::testing
