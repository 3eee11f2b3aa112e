// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frontend/fabmap/chow_liu_tree.h"
#include "frontend/fabmap/observation.h"

namespace fabloop {

/// A word of an image and how much it counts.
struct WeightedWord {
  WordId word = 0;
  double weight = 0.0;
};

/// An image as a bag of words: ascending, no repeats, weights sum to one (or empty).
using BagOfWords = std::vector<WeightedWord>;

/// log(N / n_i) of each word (Sivic & Zisserman, ICCV 2003): minus the logarithm of the share of training images that show it,
/// which is the word's marginal in the tree, smoothed as that is.
std::vector<double> inverse_document_frequencies(const ChowLiuTree& tree);

/// The bag of an image: term frequency times inverse document frequency, scaled to an L1 norm of one. `words` has one entry a
/// feature, in any order, each below the size of `idf`.
BagOfWords tf_idf_bag(std::vector<WordId> words, const std::vector<double>& idf);

/// How alike two bags are, in [0, 1]: 1 - |v / |v| - w / |w||_1 / 2 (Galvez-Lopez & Tardos, Bags of Binary Words, T-RO 2012: the
/// L1 score of DBoW2). Zero where either is empty. Without that paper's normalisation by the image before, its direct index and its
/// islands.
double l1_score(const BagOfWords& v, const BagOfWords& w);

}  // namespace fabloop
