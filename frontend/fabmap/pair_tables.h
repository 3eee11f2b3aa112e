// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "frontend/fabmap/chow_liu_tree.h"
#include "frontend/fabmap/observation.h"

namespace fabloop {

/// A number of images.
using ImageCount = std::uint32_t;

/// The smoothed 2x2 tables of all word pairs, from the counts n1 of each word and n11 of the pair alone.
///
/// To N real images are added `pseudo_count` imagined ones in which every word is seen independently with the mean frequency
/// mu of all words, so cell (a, b) of every pair gets pseudo_count * mu_a * mu_b. Then the tables of all pairs agree on the
/// marginals, and imagined images link no words. Sums of p log p are looked up, since counts are integers.
class PairTables {
 public:
  /// `counts`: in how many of the images each word is.
  PairTables(std::vector<ImageCount> counts, ImageCount num_images, double pseudo_count);

  std::size_t num_words() const { return counts_.size(); }
  ImageCount num_images() const { return num_images_; }
  ImageCount count(WordId word) const { return counts_[word]; }

  /// Nats.
  double entropy(WordId word) const { return entropy_[counts_[word]]; }

  /// The mutual information, in nats, of two words of known counts, by the number of images that show both.
  class ByImagesTogether {
   public:
    double operator()(ImageCount both) const {
      return entropies_ + (*(one_a_ - both) + *(one_b_ - both)) + (both_[both] + none_[both]);
    }

   private:
    friend class PairTables;
    double entropies_;
    const double *one_a_, *one_b_, *both_, *none_;
  };

  /// For two words seen in `n_a` and `n_b` images. The same bits with the two exchanged. `both` must be possible.
  ByImagesTogether mutual_information(ImageCount n_a, ImageCount n_b) const {
    ByImagesTogether result;
    result.entropies_ = entropy_[n_a] + entropy_[n_b];
    result.one_a_ = one_.data() + n_a;
    result.one_b_ = one_.data() + n_b;
    result.both_ = both_.data();
    result.none_ = none_.data() + (static_cast<std::ptrdiff_t>(num_images_) - n_a - n_b);
    return result;
  }

  ChowLiuNode root(WordId word) const;
  ChowLiuNode child(WordId word, WordId parent, ImageCount both) const;

 private:
  double p_log_p(double count) const;

  std::vector<ImageCount> counts_;
  ImageCount num_images_;
  double total_, pseudo_seen_, pseudo_both_, pseudo_one_, pseudo_none_;
  std::vector<double> both_, one_, none_, entropy_;  ///< By count.
};

}  // namespace fabloop
