// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "frontend/fabmap/belief.h"
#include "frontend/fabmap/observation_model.h"

namespace fabloop {

/// log p(Z | L) of many places from the words seen alone (Cummins & Newman 2011). A place starts from the likelihood that
/// nothing is seen there, kept with it; a query changes that only where its words and their children meet words of the
/// place. The model passed to each call must be the one that the index was made for.
class InvertedIndex {
 public:
  explicit InvertedIndex(const ObservationModel& model);

  /// The place after the last one.
  void add_place(const ObservationModel& model, const PlaceModel& place);

  /// The place was `before` and is now `after` one more visit.
  void add_visit(const ObservationModel& model, PlaceId id, const PlaceModel& before, const PlaceModel& after);

  /// log p(Z | L) of each place.
  std::vector<double> log_likelihoods(const ObservationModel& model, const Observation& observation) const;

  /// log p(Z | the average place), mean field.
  double log_likelihood_unvisited(const Observation& observation) const;

 private:
  /// One value for each WordState.
  using StateValues = std::array<double, kNumWordStates>;

  /// A word that a query says something else about than that neither it nor its parent was seen.
  struct Affected {
    WordId word;
    std::size_t state;
  };

  /// The terms of words never seen at a place, which depend on nothing but its number of visits.
  struct Defaults {
    double nothing_seen = 0.0;        ///< log p(Z | L) for an empty Z.
    std::vector<StateValues> change;  ///< For each word: its log p in each state, less that in WordState::Unseen.
  };

  /// A word at a place that was visited several times.
  struct Posting {
    PlaceId place;
    std::uint32_t detections;
  };

  static Defaults make_defaults(const ObservationModel& model, std::uint32_t visits);
  static StateValues gain(const ObservationModel& model, WordId word, std::uint32_t visits, std::uint32_t detections);
  static double likelihood_where_never_seen(const Defaults& defaults, const std::vector<Affected>& affected);
  std::vector<Affected> affected_words(const Observation& observation) const;
  void insert(const ObservationModel& model, PlaceId id, const PlaceModel& place);

  std::vector<std::vector<WordId>> children_;    ///< Of each word.
  std::vector<StateValues> gain_once_;           ///< gain() of each word for one visit, one detection.
  std::map<std::uint32_t, Defaults> defaults_;   ///< By number of visits: zero, one, and all that occur.
  std::vector<std::uint32_t> visits_;            ///< Of each place.
  std::vector<double> nothing_seen_;             ///< Of each place: log p(empty Z | L), less the default.
  std::vector<std::vector<PlaceId>> seen_once_;  ///< For each word: places visited once, where it was seen. Ascending.
  std::vector<std::vector<Posting>> seen_;       ///< For each word: places visited several times. Ascending.
};

}  // namespace fabloop
