// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "frontend/fabmap/chow_liu_tree.h"
#include "frontend/fabmap/observation.h"
#include "frontend/progress.h"

namespace fabloop {

struct ChowLiuOptions {
  /// How many imagined images, in which all words are independent and equally frequent, are added to the real ones. More
  /// for few training images; must be positive, since what was never seen is not impossible.
  double pseudo_count = 1.0;
  /// Links that tell less than this (nats) are cut, which leaves a forest. Zero keeps all; infinity gives naive Bayes. None:
  /// chance_mutual_information(), since what chance links harms every other image.
  std::optional<double> min_mutual_information;
  Progress progress;
};

/// A trained tree, and how much of the words' dependence it holds.
struct ChowLiuResult {
  ChowLiuTree tree;
  double mutual_information = 0.0;  ///< Sum over the links kept, nats.
  double entropy = 0.0;             ///< Sum of the words' own entropies, nats: what naive Bayes has to tell for an image.
};

/// What the best of all pairs of `num_words` independent words tells by chance in `num_images` images, nats: twice the number of
/// images times the mutual information is then about chi-square with one degree of freedom (Wilks 1938), whose largest of n
/// values is about 2 log n. So 2 log(num_words) / num_images.
double chance_mutual_information(std::size_t num_words, std::size_t num_images);

/// The maximum spanning tree of the words' pairwise mutual information in `observations`. Every 2x2 table is counted once and
/// smoothed once; marginals, conditionals and mutual information all come from it. Ties go to the lower word. The result
/// does not depend on the order of the observations. Memory grows with the words seen, not with pairs of words. Throws
/// InputError when there are no words or no observations, or when an observation names a word >= `num_words`.
ChowLiuResult train_chow_liu_tree(const std::vector<Observation>& observations, std::size_t num_words,
                                  const ChowLiuOptions& options = {});

}  // namespace fabloop
