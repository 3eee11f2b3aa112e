// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "frontend/fabmap/observation.h"

namespace fabloop {

/// What the tree knows of one word q with parent p_q. For a root, both conditionals equal the marginal.
struct ChowLiuNode {
  std::optional<WordId> parent;  ///< None for a root.
  double p = 0.0;                ///< p(z_q = 1).
  double p_if_parent = 0.0;      ///< p(z_q = 1 | z_pq = 1).
  double p_if_no_parent = 0.0;   ///< p(z_q = 1 | z_pq = 0).
};

/// Which words are seen together: the best approximation of their joint distribution in which each word depends on one
/// other (Chow & Liu 1968; Cummins & Newman 2008). A forest is allowed; naive Bayes is a tree of roots.
struct ChowLiuTree {
  std::vector<ChowLiuNode> nodes;  ///< One for each word of the vocabulary.

  std::size_t num_words() const { return nodes.size(); }
};

/// The same marginals without any links.
ChowLiuTree naive_bayes(ChowLiuTree tree);

/// Words such that every parent stands before its children, lower words first among equals. Throws InputError naming
/// `where` when a parent does not exist or the links form a cycle.
std::vector<WordId> parents_first(const ChowLiuTree& tree, const std::string& where = "Chow-Liu tree");

/// Throws InputError naming `where` and the word unless parents exist, links form no cycle, and every probability lies
/// strictly between zero and one.
void validate(const ChowLiuTree& tree, const std::string& where);

}  // namespace fabloop
