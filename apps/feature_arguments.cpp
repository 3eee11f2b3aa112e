// SPDX-License-Identifier: BSD-3-Clause
#include "apps/feature_arguments.h"

#include "frontend/error.h"
#include "frontend/features/feature_settings.h"

namespace fabloop::apps {

std::string check_feature_kind(const std::string& text) {
  if (feature_kind_from_string(text)) return "";
  return "'" + text + "' names no features: give DETECTOR or DETECTOR+DESCRIPTOR with detectors " + detector_names() +
         " and descriptors " + descriptor_names();
}

void add_feature_option_arguments(CLI::App* command, FeatureArguments& arguments, const std::string& otherwise) {
  command
      ->add_option(
          "--max-features", arguments.max_features,
          "at most so many features an image (default: " + otherwise + std::to_string(FeatureOptions{}.max_features) + ")")
      ->check(CLI::PositiveNumber);
  command->add_option("--settings", arguments.settings,
                      "YAML file with options of features, ours or openFABMAP's (`fabloop features --print-settings`)");
  command->add_option("--set", arguments.changes, "KEY=VALUE: one such option, as detection_threshold=20 or surf.num_octaves=3")
      ->allow_extra_args(false);
}

void add_feature_arguments(CLI::App* command, FeatureArguments& arguments, const std::string& otherwise) {
  command
      ->add_option("--features", arguments.features,
                   "DETECTOR[+DESCRIPTOR] (default: " + otherwise + "sift): " + detector_names() + " with " + descriptor_names())
      ->check(check_feature_kind);
  add_feature_option_arguments(command, arguments, otherwise);
}

FeatureOptions asked_features(const FeatureArguments& arguments, const FeatureOptions& base) {
  FeatureOptions asked = arguments.settings.empty() ? base : read_feature_settings(arguments.settings);
  if (arguments.features) {
    const FeatureKind kind = *feature_kind_from_string(*arguments.features);
    if (kind.detector != asked.kind.detector) asked.detection_threshold.reset();
    asked.kind = kind;
  }
  if (arguments.max_features) asked.max_features = *arguments.max_features;
  for (const std::string& change : arguments.changes) {
    const std::size_t equals = change.find('=');
    if (equals == std::string::npos) throw InputError("--set " + change + ": give KEY=VALUE");
    set_feature_option(asked, change.substr(0, equals), change.substr(equals + 1));
  }
  validate(asked);
  return asked;
}

}  // namespace fabloop::apps
