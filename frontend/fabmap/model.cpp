// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/model.h"

#include <sstream>

#include "frontend/error.h"
#include "frontend/fabmap/observation_model.h"

namespace fabloop {
namespace {

std::string as_text(std::optional<double> value) {
  if (!value) return "none";
  std::ostringstream text;
  text << *value;
  return text.str();
}

void require_same(const char* option, const std::string& of_model, const std::string& of_images) {
  if (of_model == of_images) return;
  throw InputError("the model was trained with " + std::string(option) + " " + of_model + " but the images are described with " +
                   of_images + "; use the model's own, or train another model");
}

double threshold(const FeatureOptions& features) {
  return features.detection_threshold.value_or(default_detection_threshold(features.kind));
}

}  // namespace

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

void require_features(const Model& model, const FeatureOptions& features) {
  const FeatureOptions& own = model.features;
  require_same("features", std::string(to_string(own.kind)), std::string(to_string(features.kind)));
  require_same("detection threshold", as_text(threshold(own)), as_text(threshold(features)));
  require_same("CLAHE clip limit", as_text(own.clahe_clip_limit), as_text(features.clahe_clip_limit));
  require_same("RootSIFT", own.root_sift ? "on" : "off", features.root_sift ? "on" : "off");
  require_same("a limit of features of", std::to_string(own.max_features), std::to_string(features.max_features));
}

}  // namespace fabloop
