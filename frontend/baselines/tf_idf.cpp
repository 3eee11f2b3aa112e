// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/baselines/tf_idf.h"

#include <algorithm>
#include <cmath>

namespace fabloop {

std::vector<double> inverse_document_frequencies(const ChowLiuTree& tree) {
  std::vector<double> idf;
  idf.reserve(tree.nodes.size());
  for (const ChowLiuNode& node : tree.nodes) idf.push_back(-std::log(node.p));
  return idf;
}

BagOfWords tf_idf_bag(std::vector<WordId> words, const std::vector<double>& idf) {
  std::sort(words.begin(), words.end());
  BagOfWords bag;
  double norm = 0.0;
  // The number of features, by which terms are divided, falls out of the norm.
  for (const WordId word : words) {
    if (bag.empty() || bag.back().word != word) bag.push_back({word, 0.0});
    bag.back().weight += idf[word];
    norm += idf[word];
  }
  if (!(norm > 0.0)) return {};
  for (WeightedWord& weighted : bag) weighted.weight /= norm;
  return bag;
}

double l1_score(const BagOfWords& v, const BagOfWords& w) {
  // |v - w| = |v| + |w| - 2 sum of the smaller ones, for weights that are not negative: the words of one alone need no look.
  double shared = 0.0;
  for (std::size_t i = 0, j = 0; i < v.size() && j < w.size();) {
    if (v[i].word == w[j].word) {
      shared += std::min(v[i++].weight, w[j++].weight);
    } else {
      ++(v[i].word < w[j].word ? i : j);
    }
  }
  return shared;
}

}  // namespace fabloop
