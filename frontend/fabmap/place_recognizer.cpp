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

/// The new place must not be bounded but known, so samples are never dropped.
LikelihoodEngine engine_of_samples(LikelihoodEngine engine) {
  return engine == LikelihoodEngine::BailOut ? LikelihoodEngine::InvertedIndex : engine;
}

}  // namespace

PlaceRecognizer::PlaceRecognizer(ChowLiuTree tree, DetectorModel detector, const std::vector<Observation>& background,
                                 const PlaceRecognizerOptions& options)
    : model_(validated(std::move(tree), detector)),
      terms_(model_),
      options_(options),
      places_(detector, options.engine, options.bail_out),
      samples_(detector, engine_of_samples(options.engine), {}) {
  validate(options.bail_out);
  if (options_.new_place != NewPlaceModel::Sampled) return;
  if (background.empty() || options_.max_samples == 0) {
    throw InputError(
        "the sampled new place needs background observations, and there are none; train a model with more "
        "images, or choose the mean field");
  }
  for (const std::size_t i : sample_without_replacement(background.size(), options_.max_samples, options_.seed)) {
    validate(background[i], model_.tree.num_words());
    samples_.add_place(model_, terms_, background[i]);
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
  validate(observation, model_.tree.num_words());
  BailOutResult likelihoods = places_.log_likelihoods(model_, terms_, observation);
  Belief belief = posterior(prior, std::move(likelihoods.log_likelihood), log_likelihood_new_place(observation));
  belief.bailed_out = std::move(likelihoods.dropped);
  return belief;
}

Belief PlaceRecognizer::recognize(const Observation& observation) const {
  return recognize(observation, uniform_prior(num_places()));
}

std::vector<double> PlaceRecognizer::log_likelihoods(const Observation& observation) const {
  validate(observation, model_.tree.num_words());
  return places_.log_likelihoods(model_, terms_, observation).log_likelihood;
}

double PlaceRecognizer::log_likelihood_new_place(const Observation& observation) const {
  validate(observation, model_.tree.num_words());
  if (options_.new_place == NewPlaceModel::None) return -std::numeric_limits<double>::infinity();
  if (options_.new_place == NewPlaceModel::Sampled) {
    return log_mean_exp(samples_.log_likelihoods(model_, terms_, observation).log_likelihood);
  }
  if (options_.engine == LikelihoodEngine::Exact) return log_likelihood(model_, PlaceModel{}, observation);
  return terms_.log_likelihood_average_place(observation);
}

PlaceId PlaceRecognizer::add_place(const Observation& observation) {
  validate(observation, model_.tree.num_words());
  places_.add_place(model_, terms_, observation);
  return static_cast<PlaceId>(places_.size() - 1);
}

void PlaceRecognizer::add_visit(PlaceId place, const Observation& observation) {
  assert(place < places_.size());
  validate(observation, model_.tree.num_words());
  places_.add_visit(model_, terms_, place, observation);
}

std::string_view to_string(NewPlaceModel new_place) { return name_of(kNewPlaceNames, new_place); }

std::optional<NewPlaceModel> new_place_model_from_string(std::string_view name) { return named(kNewPlaceNames, name); }

}  // namespace fabloop
