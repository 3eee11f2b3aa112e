// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/model.h"

#include <utility>

#include "frontend/error.h"
#include "frontend/fabmap/observation_model.h"
#include "frontend/features/feature_settings.h"

namespace fabloop {

void validate(const Model& model, const std::string& where) {
  validate(model.vocabulary, where);
  validate(model.tree, where);
  validate(model.detector, where);
  if (model.tree.num_words() != model.vocabulary.num_words()) {
    throw InputError(where + ": the vocabulary has " + std::to_string(model.vocabulary.num_words()) +
                     " words and the Chow-Liu tree " + std::to_string(model.tree.num_words()) + "; train the model again");
  }
  for (const Observation& observation : model.background) {
    try {
      validate(observation, model.tree.num_words());
    } catch (const InputError& error) {
      throw InputError(where + ": background: " + error.what());
    }
  }
}

Model naive_bayes(Model model) {
  model.tree = naive_bayes(std::move(model.tree));
  model.domain.reset();
  return model;
}

void require_features(const Model& model, const FeatureOptions& features) {
  const auto difference = first_difference(model.features, features);
  if (!difference) return;
  throw InputError("the model was trained with the feature option '" + difference->option + ": " + difference->a +
                   "' but the images are described with '" + difference->option + ": " + difference->b +
                   "'; use the model's own, or train another model");
}

}  // namespace fabloop
