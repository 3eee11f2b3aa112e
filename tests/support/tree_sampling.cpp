// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/tree_sampling.h"

#include <algorithm>

namespace fabloop::testing_support {

ChowLiuTree random_tree(std::size_t num_words, double mean_p, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  ChowLiuTree tree;
  for (std::size_t word = 0; word < num_words; ++word) {
    const double p = mean_p * (0.2 + 1.6 * unit(generator));
    if (word == 0) {
      tree.nodes.push_back({std::nullopt, p, p, p});
      continue;
    }
    const auto parent = static_cast<WordId>(generator() % word);
    const double parent_p = tree.nodes[parent].p;
    // The conditionals give the marginal back: p = p_if_parent parent_p + p_if_no_parent (1 - parent_p).
    const double p_if_parent = std::min(0.95, p + (std::min(1.0, p / parent_p) - p) * 0.7 * unit(generator));
    const double p_if_no_parent = (p - p_if_parent * parent_p) / (1.0 - parent_p);
    tree.nodes.push_back({parent, p, p_if_parent, p_if_no_parent});
  }
  return tree;
}

TreeSampler::TreeSampler(const ChowLiuTree& tree, std::uint64_t seed)
    : tree_(tree), order_(parents_first(tree)), generator_(seed) {}

Observation TreeSampler::draw() {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<char> seen(tree_.num_words(), 0);
  Observation observation;
  for (const WordId word : order_) {
    const ChowLiuNode& node = tree_.nodes[word];
    const double p = !node.parent ? node.p : seen[*node.parent] ? node.p_if_parent : node.p_if_no_parent;
    if (unit(generator_) >= p) continue;
    seen[word] = 1;
    observation.words.push_back(word);
  }
  std::sort(observation.words.begin(), observation.words.end());
  return observation;
}

std::vector<Observation> TreeSampler::draw(std::size_t count) {
  std::vector<Observation> observations;
  for (std::size_t i = 0; i < count; ++i) observations.push_back(draw());
  return observations;
}

}  // namespace fabloop::testing_support
