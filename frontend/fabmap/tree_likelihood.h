// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "frontend/fabmap/chow_liu_tree.h"
#include "frontend/fabmap/observation.h"

namespace fabloop {

/// log p(Z) under a Chow-Liu tree alone, without any place (Chow & Liu 1968, eq. 1): how usual an image is. Costs its words
/// and their children, not the vocabulary.
class TreeLikelihood {
 public:
  /// The tree must be valid.
  explicit TreeLikelihood(const ChowLiuTree& tree);

  /// Nats. The observation's words must be the tree's.
  double operator()(const Observation& observation) const;

 private:
  /// What the log-likelihood gains over an image without words.
  struct Word {
    double seen = 0.0;              ///< When the word is seen, its parent is not (or there is none).
    double seen_with_parent = 0.0;  ///< When both are seen.
    double parent_seen = 0.0;       ///< When its parent alone is seen.
  };

  double nothing_seen_ = 0.0;
  std::vector<Word> words_;
  std::vector<std::vector<WordId>> children_;
  std::vector<std::optional<WordId>> parents_;
};

}  // namespace fabloop
