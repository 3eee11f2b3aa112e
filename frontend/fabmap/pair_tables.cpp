// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/pair_tables.h"

#include <cmath>
#include <utility>

namespace fabloop {

PairTables::PairTables(std::vector<ImageCount> counts, ImageCount num_images, double pseudo_count)
    : counts_(std::move(counts)), num_images_(num_images) {
  double sum = 0.0;
  for (const ImageCount count : counts_) sum += count;
  // Even when all words are always (or never) seen, neither state may be impossible.
  const double cells = static_cast<double>(counts_.size()) * num_images_;
  const double mean = (sum + 0.5) / (cells + 1.0);
  pseudo_seen_ = pseudo_count * mean;
  pseudo_both_ = pseudo_seen_ * mean;
  pseudo_one_ = pseudo_seen_ * (1.0 - mean);
  pseudo_none_ = pseudo_count * (1.0 - mean) * (1.0 - mean);
  total_ = num_images_ + pseudo_count;
  for (ImageCount n = 0; n <= num_images_; ++n) {
    both_.push_back(p_log_p(n + pseudo_both_));
    one_.push_back(p_log_p(n + pseudo_one_));
    none_.push_back(p_log_p(n + pseudo_none_));
    entropy_.push_back(-p_log_p(n + pseudo_seen_) - p_log_p(num_images_ - n + pseudo_count - pseudo_seen_));
  }
}

ChowLiuNode PairTables::root(WordId word) const {
  const double p = (counts_[word] + pseudo_seen_) / total_;
  return {std::nullopt, p, p, p};
}

ChowLiuNode PairTables::child(WordId word, WordId parent, ImageCount both) const {
  ChowLiuNode node = root(word);
  const double parent_seen = counts_[parent] + pseudo_seen_;
  node.parent = parent;
  node.p_if_parent = (both + pseudo_both_) / parent_seen;
  node.p_if_no_parent = (counts_[word] - both + pseudo_one_) / (total_ - parent_seen);
  return node;
}

double PairTables::p_log_p(double count) const { return count / total_ * std::log(count / total_); }

}  // namespace fabloop
