// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "frontend/fabmap/observation_model.h"
#include "frontend/fabmap/place_store.h"
#include "frontend/fabmap/word_terms.h"

namespace fabloop {

/// log p(Z | L) of many places by look-up (OpenFABMAP's table, Glover et al. 2012): for each pair of visits and
/// detections that occurs, one row with log p of every word in every state. Exact, since rows are indexed by visits and
/// detections. 32 bytes a word and a row.
class LikelihoodTable {
 public:
  /// Makes the rows that a place with these counts needs. The model must be the one of the first call.
  void add(const ObservationModel& model, const PlaceModel& place);

  /// A place with these counts is no more. Rows that no place needs any longer go.
  void remove(const PlaceModel& place);

  /// log p(Z | L) of each place; all must have been added.
  std::vector<double> log_likelihoods(const WordTerms& terms, const PlaceStore& places, const Observation& observation) const;

 private:
  using Row = std::vector<std::array<double, kNumWordStates>>;

  /// The places visited equally often.
  struct PlacesAlike {
    std::size_t num_places = 0;
    std::vector<Row> rows;  ///< By detections; empty where that number does not occur.
  };

  std::map<std::uint32_t, PlacesAlike> by_visits_;
};

}  // namespace fabloop
