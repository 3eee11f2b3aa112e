// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/place_recognizer.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "frontend/error.h"
#include "frontend/fabmap/model.h"
#include "frontend/fabmap/sampling.h"
#include "frontend/names.h"

namespace fabloop {
namespace {

constexpr std::array<Named<NewPlaceModel>, 3> kNewPlaceNames{
    {{NewPlaceModel::MeanField, "mean-field"}, {NewPlaceModel::Sampled, "sampled"}, {NewPlaceModel::None, "off"}}};
constexpr std::array<Named<LikelihoodEngine>, 2> kEngineNames{
    {{LikelihoodEngine::Exact, "exact"}, {LikelihoodEngine::InvertedIndex, "index"}}};

ObservationModel validated(ChowLiuTree tree, const DetectorModel& detector) {
  validate(tree, "Chow-Liu tree");
  validate(detector, "detector");
  return {std::move(tree), detector};
}

/// log of the mean of exp(values).
double log_mean_exp(const std::vector<double>& values) {
  const double highest = *std::max_element(values.begin(), values.end());
  double sum = 0.0;
  for (const double value : values) sum += std::exp(value - highest);
  return highest + std::log(sum / static_cast<double>(values.size()));
}

}  // namespace

PlaceRecognizer::PlaceRecognizer(ChowLiuTree tree, DetectorModel detector, const std::vector<Observation>& background,
                                 const PlaceRecognizerOptions& options)
    : model_(validated(std::move(tree), detector)), options_(options), index_(model_), sample_index_(model_) {
  if (options_.new_place != NewPlaceModel::Sampled) return;
  if (background.empty() || options_.max_samples == 0) {
    throw InputError(
        "the sampled new place needs background observations, and there are none; train a model with more "
        "images, or choose the mean field");
  }
  for (const std::size_t i : sample_without_replacement(background.size(), options_.max_samples, options_.seed)) {
    validate(background[i], model_.tree.num_words());
    fabloop::add_visit(samples_.emplace_back(), background[i]);
    sample_index_.add_place(model_, samples_.back());
  }
}

PlaceRecognizer::PlaceRecognizer(const Model& model, const PlaceRecognizerOptions& options)
    : PlaceRecognizer(model.tree, model.detector, model.background, options) {}

Belief PlaceRecognizer::recognize(const Observation& observation, const Prior& prior) const {
  if (prior.p_place.empty() && num_places() == 0) {
    Belief nowhere;
    if (options_.new_place != NewPlaceModel::None) nowhere.log_likelihood_new = log_likelihood_new_place(observation);
    return nowhere;
  }
  return posterior(prior, log_likelihoods(observation), log_likelihood_new_place(observation));
}

Belief PlaceRecognizer::recognize(const Observation& observation) const {
  return recognize(observation, uniform_prior(num_places()));
}

std::vector<double> PlaceRecognizer::log_likelihoods(const Observation& observation) const {
  return log_likelihoods(places_, index_, observation);
}

double PlaceRecognizer::log_likelihood_new_place(const Observation& observation) const {
  if (options_.new_place == NewPlaceModel::None) return -std::numeric_limits<double>::infinity();
  if (options_.new_place == NewPlaceModel::Sampled) return log_mean_exp(log_likelihoods(samples_, sample_index_, observation));
  if (options_.engine == LikelihoodEngine::Exact) return log_likelihood(model_, PlaceModel{}, observation);
  validate(observation, model_.tree.num_words());
  return index_.log_likelihood_unvisited(observation);
}

std::vector<double> PlaceRecognizer::log_likelihoods(const std::vector<PlaceModel>& places, const InvertedIndex& index,
                                                     const Observation& observation) const {
  validate(observation, model_.tree.num_words());
  if (options_.engine == LikelihoodEngine::InvertedIndex) return index.log_likelihoods(model_, observation);
  std::vector<double> result;
  result.reserve(places.size());
  for (const PlaceModel& place : places) result.push_back(log_likelihood(model_, place, observation));
  return result;
}

PlaceId PlaceRecognizer::add_place(const Observation& observation) {
  validate(observation, model_.tree.num_words());
  fabloop::add_visit(places_.emplace_back(), observation);
  index_.add_place(model_, places_.back());
  return static_cast<PlaceId>(places_.size() - 1);
}

void PlaceRecognizer::add_visit(PlaceId place, const Observation& observation) {
  assert(place < places_.size());
  validate(observation, model_.tree.num_words());
  const PlaceModel before = places_[place];
  fabloop::add_visit(places_[place], observation);
  index_.add_visit(model_, place, before, places_[place]);
}

std::string_view to_string(NewPlaceModel new_place) { return name_of(kNewPlaceNames, new_place); }

std::optional<NewPlaceModel> new_place_model_from_string(std::string_view name) { return named(kNewPlaceNames, name); }

std::string_view to_string(LikelihoodEngine engine) { return name_of(kEngineNames, engine); }

std::optional<LikelihoodEngine> likelihood_engine_from_string(std::string_view name) { return named(kEngineNames, name); }

}  // namespace fabloop
