// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/chow_liu_training.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "frontend/fabmap/observation_model.h"

namespace fabloop {
namespace {

using Count = std::uint32_t;

/// The smoothed 2x2 tables of all word pairs, from the counts n1 of each word and n11 of the pair alone.
///
/// To N real images are added `pseudo_count` imagined ones in which every word is seen independently with the mean frequency
/// mu of all words, so cell (a, b) of every pair gets pseudo_count * mu_a * mu_b. Then the tables of all pairs agree on the
/// marginals, and imagined images link no words. Sums of p log p are looked up, since counts are integers.
class PairTables {
 public:
  PairTables(std::vector<Count> counts, Count num_images, double pseudo_count)
      : counts_(std::move(counts)), num_images_(num_images) {
    double sum = 0.0;
    for (const Count count : counts_) sum += count;
    // Even when all words are always (or never) seen, neither state may be impossible.
    const double cells = static_cast<double>(counts_.size()) * num_images_;
    const double mean = (sum + 0.5) / (cells + 1.0);
    pseudo_seen_ = pseudo_count * mean;
    pseudo_both_ = pseudo_seen_ * mean;
    pseudo_one_ = pseudo_seen_ * (1.0 - mean);
    pseudo_none_ = pseudo_count * (1.0 - mean) * (1.0 - mean);
    total_ = num_images_ + pseudo_count;
    for (Count n = 0; n <= num_images_; ++n) {
      both_.push_back(p_log_p(n + pseudo_both_));
      one_.push_back(p_log_p(n + pseudo_one_));
      none_.push_back(p_log_p(n + pseudo_none_));
      entropy_.push_back(-p_log_p(n + pseudo_seen_) - p_log_p(num_images_ - n + pseudo_count - pseudo_seen_));
    }
  }

  double entropy(WordId word) const { return entropy_[counts_[word]]; }

  double mutual_information(WordId a, WordId b, Count both) const {
    const Count n_a = counts_[a];
    const Count n_b = counts_[b];
    return entropy_[n_a] + entropy_[n_b] + both_[both] + one_[n_a - both] + one_[n_b - both] +
           none_[num_images_ + both - n_a - n_b];
  }

  ChowLiuNode root(WordId word) const {
    const double p = (counts_[word] + pseudo_seen_) / total_;
    return {std::nullopt, p, p, p};
  }

  ChowLiuNode child(WordId word, WordId parent, Count both) const {
    ChowLiuNode node = root(word);
    const double parent_seen = counts_[parent] + pseudo_seen_;
    node.parent = parent;
    node.p_if_parent = (both + pseudo_both_) / parent_seen;
    node.p_if_no_parent = (counts_[word] - both + pseudo_one_) / (total_ - parent_seen);
    return node;
  }

 private:
  double p_log_p(double count) const { return count / total_ * std::log(count / total_); }

  std::vector<Count> counts_;
  Count num_images_;
  double total_, pseudo_seen_, pseudo_both_, pseudo_one_, pseudo_none_;
  std::vector<double> both_, one_, none_, entropy_;  // By count.
};

/// For each word, the images that show it.
std::vector<std::vector<std::uint32_t>> images_by_word(const std::vector<Observation>& observations, std::size_t num_words) {
  std::vector<std::vector<std::uint32_t>> images(num_words);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    validate(observations[i], num_words);
    for (const WordId word : observations[i].words) images[word].push_back(static_cast<std::uint32_t>(i));
  }
  return images;
}

/// A word outside the tree, and its best link into it.
struct Candidate {
  WordId word;
  WordId parent;
  Count both;
  double mutual_information;
};

/// Words outside the tree, each with its best link into it (Prim 1957).
class Frontier {
 public:
  explicit Frontier(std::size_t num_words) {
    for (WordId word = 1; word < num_words; ++word) candidates_.push_back({word, 0, 0, -1.0});
  }

  bool empty() const { return candidates_.empty(); }

  /// Takes out the word with the best link, once `added` is in the tree. `together` counts the images that show `added` and
  /// each word.
  Candidate take_best(const PairTables& tables, WordId added, const std::vector<Count>& together) {
    std::size_t best = 0;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      Candidate& candidate = candidates_[i];
      const Candidate link = {candidate.word, added, together[candidate.word],
                              tables.mutual_information(candidate.word, added, together[candidate.word])};
      if (is_better(link, candidate)) candidate = link;
      if (is_better(candidate, candidates_[best])) best = i;
    }
    const Candidate chosen = candidates_[best];
    candidates_[best] = candidates_.back();
    candidates_.pop_back();
    return chosen;
  }

 private:
  static bool is_better(const Candidate& a, const Candidate& b) {
    if (a.mutual_information != b.mutual_information) return a.mutual_information > b.mutual_information;
    return a.word != b.word ? a.word < b.word : a.parent < b.parent;
  }

  std::vector<Candidate> candidates_;
};

/// For each word, how many images show it together with `word`.
std::vector<Count> count_together(WordId word, const std::vector<std::vector<std::uint32_t>>& images,
                                  const std::vector<Observation>& observations) {
  std::vector<Count> together(images.size(), 0);
  for (const std::uint32_t image : images[word]) {
    for (const WordId other : observations[image].words) ++together[other];
  }
  return together;
}

}  // namespace

ChowLiuResult train_chow_liu_tree(const std::vector<Observation>& observations, std::size_t num_words,
                                  const ChowLiuOptions& options) {
  if (num_words == 0) throw InputError("a Chow-Liu tree needs at least one word; train on images with features");
  if (observations.empty()) throw InputError("a Chow-Liu tree needs at least one observation; train on more images");
  if (!(options.pseudo_count > 0.0)) throw InputError("the pseudo count must be positive");
  const auto images = images_by_word(observations, num_words);
  std::vector<Count> counts;
  for (const auto& word_images : images) counts.push_back(static_cast<Count>(word_images.size()));
  const PairTables tables(counts, static_cast<Count>(observations.size()), options.pseudo_count);

  ChowLiuResult result;
  for (WordId word = 0; word < num_words; ++word) {
    result.tree.nodes.push_back(tables.root(word));
    result.entropy += tables.entropy(word);
  }
  Frontier frontier(num_words);
  WordId added = 0;
  for (std::size_t num_linked = 1; !frontier.empty(); ++num_linked) {
    const Candidate link = frontier.take_best(tables, added, count_together(added, images, observations));
    added = link.word;
    if (link.mutual_information >= options.min_mutual_information) {
      result.tree.nodes[added] = tables.child(added, link.parent, link.both);
      result.mutual_information += link.mutual_information;
    }
    if (options.progress) options.progress("linking words", num_linked + 1, num_words);
  }
  return result;
}

}  // namespace fabloop
