// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "frontend/fabmap/bail_out.h"
#include "frontend/fabmap/inverted_index.h"
#include "frontend/fabmap/likelihood_table.h"
#include "frontend/fabmap/observation_model.h"
#include "frontend/fabmap/place_store.h"
#include "frontend/fabmap/visit_counts.h"
#include "frontend/fabmap/word_terms.h"

namespace fabloop {

/// Ways to one number: log p(Z | L) of every place.
enum class LikelihoodEngine {
  Exact,          ///< Every word at every place (Cummins & Newman 2008). The reference.
  Table,          ///< The words of every place, from a table (Glover et al. 2012). The same to 1e-9.
  BailOut,        ///< The index, which drops places that fall behind (Cummins & Newman 2010). Kept places the same to 1e-9.
  InvertedIndex,  ///< Only the words seen (Cummins & Newman 2011). The same to 1e-9, and the fastest.
};

/// "exact", "table", "bail-out", "index": the names used in options and files.
std::string_view to_string(LikelihoodEngine engine);
std::optional<LikelihoodEngine> likelihood_engine_from_string(std::string_view name);

/// Places, and how likely an observation is at each of them. Keeps what its engine needs and no more. The model and the terms
/// passed to each call must be those of the first one.
class PlaceLikelihoods {
 public:
  PlaceLikelihoods(const DetectorModel& detector, LikelihoodEngine engine, const BailOutOptions& bail_out)
      : engine_(engine), bail_out_(bail_out), counts_(detector) {}

  void add_place(const ObservationModel& model, const WordTerms& terms, const Observation& observation);
  void add_visit(const ObservationModel& model, const WordTerms& terms, PlaceId place, const Observation& observation);

  /// log p(Z | L) of each place. Only LikelihoodEngine::BailOut drops any.
  BailOutResult log_likelihoods(const ObservationModel& model, const WordTerms& terms, const Observation& observation) const;

  std::size_t size() const { return places_.size(); }
  PlaceModel operator[](PlaceId place) const { return places_[place]; }

 private:
  bool is_indexed() const { return engine_ == LikelihoodEngine::InvertedIndex || engine_ == LikelihoodEngine::BailOut; }

  LikelihoodEngine engine_;
  BailOutOptions bail_out_;
  VisitCounts counts_;
  PlaceStore places_;
  InvertedIndex index_;    ///< For InvertedIndex and BailOut.
  LikelihoodTable table_;  ///< For Table.
};

}  // namespace fabloop
