// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "frontend/fabmap/observation_model.h"
#include "frontend/fabmap/visit_counts.h"

namespace fabloop {

/// A word that an observation says something else about than that neither it nor its parent was seen.
struct AffectedWord {
  WordId word;
  WordState state;
};

/// What the fast engines look up instead of computing it anew: the terms of every word, and who its children are.
class WordTerms {
 public:
  explicit WordTerms(const ObservationModel& model);

  std::size_t num_words() const { return terms_.size(); }

  const DetectorModel& detector() const { return detector_; }

  /// The words that `observation` affects: those seen, and their children. Each once.
  std::vector<AffectedWord> affected_words(const Observation& observation) const;

  /// log p(Z | the average place), mean field (Glover et al. 2012, eq. 7).
  double log_likelihood_average_place(const Observation& observation) const;

  /// log p(Z = nothing | L) at a place visited so often where no word was ever seen.
  double nothing_seen_where_never_seen(double factor_unseen) const;

  /// How log p of a word that was never seen at a place changes from WordState::Unseen to `affected.state`.
  double change_where_never_seen(const AffectedWord& affected, double factor_unseen) const;

  /// How log p of an unseen word (and parent) differs between a place where it was seen and one where it never was.
  double gain(WordId word, const Counts& counts) const;

  /// How gain() changes from WordState::Unseen to `affected.state`.
  double change_of_gain(const AffectedWord& affected, const Counts& counts) const;

  /// p(e=1) of the word at a place of which nothing is known.
  double p_present_anywhere(WordId word) const { return terms_[word].odds_anywhere / (1.0 + terms_[word].odds_anywhere); }

 private:
  std::span<const WordId> children(WordId word) const {
    return {children_.data() + first_child_[word], children_.data() + first_child_[word + 1]};
  }

  DetectorModel detector_;
  std::vector<WordLikelihood> terms_;       ///< Of each word.
  std::vector<std::uint32_t> first_child_;  ///< For each word, where its children start; and the end of the last ones.
  std::vector<WordId> children_;
  double nothing_seen_at_average_place_;
};

}  // namespace fabloop
