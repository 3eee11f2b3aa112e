// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/tree_likelihood.h"

#include <algorithm>
#include <cmath>

namespace fabloop {

TreeLikelihood::TreeLikelihood(const ChowLiuTree& tree)
    : words_(tree.num_words()), children_(tree.num_words()), parents_(tree.num_words()) {
  for (WordId word = 0; word < tree.num_words(); ++word) {
    const ChowLiuNode& node = tree.nodes[word];
    const double unseen = std::log1p(-node.p_if_no_parent);
    nothing_seen_ += unseen;
    words_[word] = {std::log(node.p_if_no_parent) - unseen, std::log(node.p_if_parent) - unseen,
                    std::log1p(-node.p_if_parent) - unseen};
    parents_[word] = node.parent;
    if (node.parent) children_[*node.parent].push_back(word);
  }
}

double TreeLikelihood::operator()(const Observation& observation) const {
  const auto is_seen = [&](WordId word) { return std::binary_search(observation.words.begin(), observation.words.end(), word); };
  double sum = nothing_seen_;
  for (const WordId word : observation.words) {
    sum += parents_[word] && is_seen(*parents_[word]) ? words_[word].seen_with_parent : words_[word].seen;
    for (const WordId child : children_[word]) {
      if (!is_seen(child)) sum += words_[child].parent_seen;
    }
  }
  return sum;
}

}  // namespace fabloop
