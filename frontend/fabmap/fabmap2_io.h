// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <utility>
#include <vector>

#include "frontend/fabmap/chow_liu_tree.h"
#include "frontend/fabmap/observation.h"

namespace fabloop {

/// The FAB-MAP 2.0 authors' own tree (Cummins & Newman 2011) and some of their images, as tables of text. There are no words'
/// descriptors with it, so it cannot describe other images.
struct FabMap2Model {
  ChowLiuTree tree;
  std::map<int, Observation> observations;      ///< By index of the image in their sequence.
  std::vector<std::pair<int, int>> true_pairs;  ///< Query, match: images of one place.
};

/// `chow_liu_tree.csv`: lines `word,parent,p,p_if_parent,p_unseen_if_no_parent`, words in order from 0, parent -1 for a root.
/// The last column is p(z = 0 | parent not seen). Lines that are empty or begin with # are left out. Throws InputError naming
/// file and line, and as validate does for the tree.
ChowLiuTree read_fabmap2_tree(const std::filesystem::path& path);

/// `bow.csv`: lines `image,name,keypoints,word:count word:count ...`. Throws InputError naming file and line for anything
/// else, for words >= `num_words` and for an image that comes twice.
std::map<int, Observation> read_fabmap2_images(const std::filesystem::path& path, std::size_t num_words);

/// Reads both, and `gt_pairs.csv` (lines `query,match`), from a folder. Throws InputError also for pairs of images that are not
/// there.
FabMap2Model read_fabmap2(const std::filesystem::path& folder);

}  // namespace fabloop
