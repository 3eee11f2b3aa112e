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
#include "frontend/fabmap/revisited_places.h"
#include "frontend/fabmap/visit_counts.h"
#include "frontend/fabmap/word_terms.h"

namespace fabloop {

/// log p(Z | L) of many places from the words seen alone (Cummins & Newman 2011). A place starts from the likelihood that
/// nothing is seen there, kept with it; a query changes that only where its words and their children meet words of the
/// place. The WordTerms and VisitCounts passed to each call must be those of the first one.
class InvertedIndex {
 public:
  /// A query in the index's terms.
  struct Query {
    std::vector<AffectedWord> words;
    std::vector<double> change_once;                   ///< What each of `words` adds to a place that saw it at its only visit.
    std::map<std::uint32_t, double> where_never_seen;  ///< By number of visits: log p(Z | a place that knows no word).
  };

  /// The place after the last one, visited once.
  void add_place(const WordTerms& terms, const VisitCounts& counts, const Observation& observation);

  /// The place was `before` and is now `after` one more visit.
  void add_visit(const WordTerms& terms, VisitCounts& counts, PlaceId id, const PlaceModel& before, const PlaceModel& after);

  /// log p(Z | L) of each place.
  std::vector<double> log_likelihoods(const WordTerms& terms, const VisitCounts& counts, const Observation& observation) const;

  /// The same in steps, for engines that may stop early: what a query is made of; where each place starts from; and what
  /// the query's words from `first` up to `last` add.
  Query prepare(const WordTerms& terms, const VisitCounts& counts, const Observation& observation) const;
  std::vector<double> start(const Query& query) const;
  void add_words(const WordTerms& terms, const VisitCounts& counts, const Query& query, std::size_t first, std::size_t last,
                 std::vector<double>& log_likelihood) const;

 private:
  std::vector<PostingBlock> blocks_;  ///< Of all places, as their first visits left them.
  std::vector<double> nothing_seen_;  ///< Of each place after one visit: log p(empty Z | L).
  RevisitedPlaces revisited_;         ///< What holds instead where there were more visits.
  std::vector<double> gain_once_;     ///< WordTerms::gain of each word for one visit, one detection; from the first place on.
  double nothing_seen_where_never_seen_ = 0.0;  ///< log p(empty Z | a place visited once that knows no word).
};

}  // namespace fabloop
