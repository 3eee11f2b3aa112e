// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/chow_liu_training.h"

#include <cmath>
#include <cstdint>

#include "frontend/error.h"
#include "frontend/fabmap/chow_liu_frontier.h"
#include "frontend/fabmap/observation_model.h"
#include "frontend/fabmap/pair_tables.h"

namespace fabloop {
namespace {

/// In how many of the observations each word is.
std::vector<ImageCount> image_counts(const std::vector<Observation>& observations, std::size_t num_words) {
  std::vector<ImageCount> counts(num_words, 0);
  for (const Observation& observation : observations) {
    validate(observation, num_words);
    for (const WordId word : observation.words) ++counts[word];
  }
  return counts;
}

}  // namespace

double chance_mutual_information(std::size_t num_words, std::size_t num_images) {
  return 2.0 * std::log(static_cast<double>(num_words)) / static_cast<double>(num_images);
}

ChowLiuResult train_chow_liu_tree(const std::vector<Observation>& observations, std::size_t num_words,
                                  const ChowLiuOptions& options) {
  if (num_words == 0) throw InputError("a Chow-Liu tree needs at least one word; train on images with features");
  if (observations.empty()) throw InputError("a Chow-Liu tree needs at least one observation; train on more images");
  if (!(options.pseudo_count > 0.0)) throw InputError("the pseudo count must be positive");
  const PairTables tables(image_counts(observations, num_words), static_cast<ImageCount>(observations.size()),
                          options.pseudo_count);

  ChowLiuResult result;
  for (WordId word = 0; word < num_words; ++word) {
    result.tree.nodes.push_back(tables.root(word));
    result.entropy += tables.entropy(word);
  }
  const double least = options.min_mutual_information.value_or(chance_mutual_information(num_words, observations.size()));
  ChowLiuFrontier frontier(observations, tables);
  for (std::size_t num_linked = 1; num_linked < num_words; ++num_linked) {
    const ChowLiuLink link = frontier.take_best();
    if (link.mutual_information >= least) {
      result.tree.nodes[link.word] = tables.child(link.word, link.parent, link.both);
      result.mutual_information += link.mutual_information;
    }
    if (options.progress) options.progress("linking words", num_linked + 1, num_words);
  }
  return result;
}

}  // namespace fabloop
