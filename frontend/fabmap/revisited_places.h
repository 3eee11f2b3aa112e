// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "frontend/fabmap/belief.h"
#include "frontend/fabmap/place_model.h"
#include "frontend/fabmap/visit_counts.h"
#include "frontend/fabmap/word_terms.h"

namespace fabloop {

/// The part of an inverted index that holds the places visited more than once: for each word, at which of them it was seen, and
/// how often. There are as many different gains as VisitCounts, so each is computed once for a word of a query.
class RevisitedPlaces {
 public:
  /// The place was `before` and is now `after` one more visit.
  void add_visit(const WordTerms& terms, VisitCounts& counts, PlaceId place, const PlaceModel& before, const PlaceModel& after);

  /// Numbers of visits that occur, each with log p(Z = nothing | a place visited so often that knows no word).
  const std::map<std::uint32_t, double>& where_never_seen() const { return where_never_seen_; }

  /// Where the places start from, one after another; `where_never_seen` says that of a place that knows no word, by visits.
  std::vector<double> start(const std::map<std::uint32_t, double>& where_never_seen) const;

  /// Adds what affected words say to the log-likelihoods of these places, one after another.
  void add_words(const WordTerms& terms, const VisitCounts& counts, std::span<const AffectedWord> words,
                 std::vector<double>& log_likelihood) const;

  /// The entries of these places among those of all places, and the way back.
  std::vector<double> gather(const std::vector<double>& of_all_places) const;
  void scatter(const std::vector<double>& log_likelihood, std::vector<double>& of_all_places) const;

 private:
  /// Where a word was seen, ascending by number of the place, and by which VisitCounts.
  struct Postings {
    std::vector<std::uint32_t> places;
    std::vector<std::uint32_t> counts;
  };

  void set(std::uint32_t number, WordId word, std::uint32_t counts);

  std::map<PlaceId, std::uint32_t> number_of_place_;  ///< In the order of their first revisits.
  std::vector<PlaceId> places_;                       ///< By number.
  std::vector<double> nothing_seen_;                  ///< By number: log p(empty Z | L), less that of a place that knows no word.
  std::vector<std::uint32_t> visits_;                 ///< By number.
  std::map<std::uint32_t, std::size_t> num_places_;   ///< By visits.
  std::map<std::uint32_t, double> where_never_seen_;  ///< By visits.
  std::vector<Postings> postings_;                    ///< For each word.
};

}  // namespace fabloop
