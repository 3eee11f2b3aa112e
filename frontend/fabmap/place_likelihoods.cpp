// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/place_likelihoods.h"

#include <array>

#include "frontend/names.h"

namespace fabloop {
namespace {

constexpr std::array<Named<LikelihoodEngine>, 4> kEngineNames{{{LikelihoodEngine::Exact, "exact"},
                                                               {LikelihoodEngine::Table, "table"},
                                                               {LikelihoodEngine::BailOut, "bail-out"},
                                                               {LikelihoodEngine::InvertedIndex, "index"}}};

}  // namespace

void PlaceLikelihoods::add_place(const ObservationModel& model, const WordTerms& terms, const Observation& observation) {
  PlaceModel place;
  fabloop::add_visit(place, observation);
  places_.push_back(place);
  if (is_indexed()) index_.add_place(terms, counts_, observation);
  if (engine_ == LikelihoodEngine::Table) table_.add(model, place);
}

void PlaceLikelihoods::add_visit(const ObservationModel& model, const WordTerms& terms, PlaceId id,
                                 const Observation& observation) {
  const PlaceModel before = places_[id];
  PlaceModel after = before;
  fabloop::add_visit(after, observation);
  places_.set(id, after);
  if (is_indexed()) index_.add_visit(terms, counts_, id, before, after);
  if (engine_ == LikelihoodEngine::Table) {
    table_.add(model, after);
    table_.remove(before);
  }
}

BailOutResult PlaceLikelihoods::log_likelihoods(const ObservationModel& model, const WordTerms& terms,
                                                const Observation& observation) const {
  switch (engine_) {
    case LikelihoodEngine::InvertedIndex:
      return {index_.log_likelihoods(terms, counts_, observation), {}};
    case LikelihoodEngine::BailOut:
      return log_likelihoods_with_bail_out(terms, counts_, places_, index_, observation, bail_out_);
    case LikelihoodEngine::Table:
      return {table_.log_likelihoods(terms, places_, observation), {}};
    case LikelihoodEngine::Exact:
      break;
  }
  BailOutResult result;
  for (PlaceId place = 0; place < places_.size(); ++place) {
    result.log_likelihood.push_back(log_likelihood(model, places_[place], observation));
  }
  return result;
}

std::string_view to_string(LikelihoodEngine engine) { return name_of(kEngineNames, engine); }

std::optional<LikelihoodEngine> likelihood_engine_from_string(std::string_view name) { return named(kEngineNames, name); }

}  // namespace fabloop
