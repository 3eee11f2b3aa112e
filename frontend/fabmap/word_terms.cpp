// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/word_terms.h"

#include <cmath>

namespace fabloop {
WordTerms::WordTerms(const ObservationModel& model) : detector_(model.detector) {
  const std::size_t num_words = model.tree.num_words();
  terms_.reserve(num_words);
  first_child_.assign(num_words + 1, 0);
  for (WordId word = 0; word < num_words; ++word) {
    terms_.push_back(word_likelihood(model, word));
    if (const auto parent = model.tree.nodes[word].parent) ++first_child_[*parent + 1];
  }
  for (std::size_t word = 0; word < num_words; ++word) first_child_[word + 1] += first_child_[word];
  children_.resize(first_child_.back());
  std::vector<std::uint32_t> next = first_child_;
  for (WordId word = 0; word < num_words; ++word) {
    if (const auto parent = model.tree.nodes[word].parent) children_[next[*parent]++] = word;
  }
  nothing_seen_at_average_place_ = nothing_seen_where_never_seen(1.0);
}

std::vector<AffectedWord> WordTerms::affected_words(const Observation& observation) const {
  std::vector<char> seen(num_words(), 0), listed(num_words(), 0);
  for (const WordId word : observation.words) seen[word] = 1;
  std::vector<AffectedWord> affected;
  for (const WordId word : observation.words) {
    for (const WordId child : children(word)) {
      affected.push_back({child, seen[child] ? WordState::SeenWithParent : WordState::UnseenParentSeen});
      listed[child] = 1;
    }
  }
  for (const WordId word : observation.words) {
    if (!listed[word]) affected.push_back({word, WordState::SeenParentUnseen});
  }
  return affected;
}

double WordTerms::log_likelihood_average_place(const Observation& observation) const {
  double sum = nothing_seen_at_average_place_;
  for (const AffectedWord& affected : affected_words(observation)) sum += change_where_never_seen(affected, 1.0);
  return sum;
}

double WordTerms::nothing_seen_where_never_seen(double factor_unseen) const {
  double sum = 0.0;
  for (const WordLikelihood& word : terms_) sum += log_p(word, WordState::Unseen, word.odds_anywhere * factor_unseen);
  return sum;
}

double WordTerms::change_where_never_seen(const AffectedWord& affected, double factor_unseen) const {
  const WordLikelihood& word = terms_[affected.word];
  const double odds = word.odds_anywhere * factor_unseen;
  return std::log(unscaled_p(word, affected.state, odds) / unscaled_p(word, WordState::Unseen, odds));
}

double WordTerms::gain(WordId word, const Counts& counts) const {
  const WordLikelihood& terms = terms_[word];
  return log_p(terms, WordState::Unseen, terms.odds_anywhere * counts.factor) -
         log_p(terms, WordState::Unseen, terms.odds_anywhere * counts.factor_unseen);
}

double WordTerms::change_of_gain(const AffectedWord& affected, const Counts& counts) const {
  const WordLikelihood& word = terms_[affected.word];
  const double odds = word.odds_anywhere * counts.factor;
  const double odds_unseen = word.odds_anywhere * counts.factor_unseen;
  // (1 + odds) of the four terms cancels, which leaves one logarithm.
  return std::log(unscaled_p(word, affected.state, odds) * unscaled_p(word, WordState::Unseen, odds_unseen) /
                  (unscaled_p(word, WordState::Unseen, odds) * unscaled_p(word, affected.state, odds_unseen)));
}

}  // namespace fabloop
