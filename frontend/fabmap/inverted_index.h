// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "frontend/fabmap/belief.h"
#include "frontend/fabmap/place_model.h"
#include "frontend/fabmap/posting_block.h"
#include "frontend/fabmap/visit_counts.h"
#include "frontend/fabmap/word_terms.h"

namespace fabloop {

/// log p(Z | L) of many places from the words seen alone (Cummins & Newman 2011). A place starts from the likelihood that
/// nothing is seen there, kept with it; a query changes that only where its words and their children meet words of the
/// place. The WordTerms and VisitCounts passed to each call must be those of the first one.
class InvertedIndex {
 public:
  /// An affected word of a query, and what it adds to a place visited once that knows it.
  struct QueryWord {
    AffectedWord affected;
    double change_once;
  };

  /// A query in the index's terms.
  struct Query {
    std::vector<QueryWord> words;
    std::map<std::uint32_t, double> where_never_seen;  ///< By number of visits: log p(Z | a place that knows no word).
  };

  /// The place after the last one, visited once.
  void add_place(const WordTerms& terms, VisitCounts& counts, const Observation& observation);

  /// The place was `before` and is now `after` one more visit.
  void add_visit(const WordTerms& terms, VisitCounts& counts, PlaceId id, const PlaceModel& before, const PlaceModel& after);

  /// log p(Z | L) of each place.
  std::vector<double> log_likelihoods(const WordTerms& terms, const VisitCounts& counts, const Observation& observation) const;

  /// The same in steps, for engines that may stop early: what a query is made of; where each place starts from; and what
  /// some of the query's words add.
  Query prepare(const WordTerms& terms, const VisitCounts& counts, const Observation& observation) const;
  std::vector<double> start(const Query& query) const;
  void add_words(const WordTerms& terms, const VisitCounts& counts, std::span<const QueryWord> words,
                 std::vector<double>& log_likelihood) const;

 private:
  /// The places visited equally often.
  struct PlacesAlike {
    std::size_t num_places = 0;
    double nothing_seen_where_never_seen = 0.0;  ///< log p(empty Z | such a place that knows no word).
  };

  void count_place(const WordTerms& terms, std::uint32_t visits);
  void start_block(const Query& query, std::size_t block, double* log_likelihood) const;
  void add_words_to_block(const WordTerms& terms, const VisitCounts& counts, std::span<const QueryWord> words, std::size_t block,
                          double* log_likelihood) const;

  std::vector<PostingBlock> blocks_;
  std::vector<double> nothing_seen_;   ///< Of each place: log p(empty Z | L), less that of a place that knows no word.
  std::vector<std::uint32_t> visits_;  ///< Of each place.
  std::map<std::uint32_t, PlacesAlike> by_visits_;
  std::vector<double> gain_once_;  ///< WordTerms::gain of each word for one visit, one detection; from the first place on.
};

}  // namespace fabloop
