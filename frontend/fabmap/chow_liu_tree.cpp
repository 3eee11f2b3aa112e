// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/chow_liu_tree.h"

#include <numeric>

#include "frontend/error.h"

namespace fabloop {
namespace {

bool is_strictly_between_zero_and_one(double p) { return p > 0.0 && p < 1.0; }

}  // namespace

ChowLiuTree naive_bayes(ChowLiuTree tree) {
  for (ChowLiuNode& node : tree.nodes) node = {std::nullopt, node.p, node.p, node.p};
  return tree;
}

std::vector<WordId> parents_first(const ChowLiuTree& tree, const std::string& where) {
  const std::size_t num_words = tree.num_words();
  std::vector<WordId> order;
  order.reserve(num_words);
  std::vector<WordId> starts(num_words + 2, 0);  // Two further than the parent: filling moves each to where it belongs.
  for (WordId word = 0; word < num_words; ++word) {
    const auto parent = tree.nodes[word].parent;
    if (!parent) {
      order.push_back(word);
    } else if (*parent >= num_words) {
      throw InputError(where + ": word " + std::to_string(word) + " has parent " + std::to_string(*parent) +
                       " but there are only " + std::to_string(num_words) + " words; train the model again");
    } else {
      ++starts[*parent + 2];
    }
  }
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  std::vector<WordId> children(num_words - order.size());  // Of word w: from starts[w] to starts[w + 1].
  for (WordId word = 0; word < num_words; ++word) {
    if (const auto parent = tree.nodes[word].parent) children[starts[*parent + 1]++] = word;
  }
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (WordId child = starts[order[i]]; child < starts[order[i] + 1]; ++child) order.push_back(children[child]);
  }
  if (order.size() != num_words) {
    throw InputError(where + ": the links of " + std::to_string(num_words - order.size()) +
                     " words lead in a circle, not to a root; train the model again");
  }
  return order;
}

void validate(const ChowLiuTree& tree, const std::string& where) {
  if (tree.nodes.empty()) throw InputError(where + ": the Chow-Liu tree has no words; train the model again");
  for (WordId word = 0; word < tree.num_words(); ++word) {
    const ChowLiuNode& node = tree.nodes[word];
    for (const double p : {node.p, node.p_if_parent, node.p_if_no_parent}) {
      if (is_strictly_between_zero_and_one(p)) continue;
      throw InputError(where + ": word " + std::to_string(word) + " has probability " + std::to_string(p) +
                       ", which must lie strictly between 0 and 1; train the model again");
    }
  }
  parents_first(tree, where);
}

}  // namespace fabloop
