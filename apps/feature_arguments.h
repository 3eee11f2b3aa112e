// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "frontend/features/feature_options.h"

namespace fabloop::apps {

/// How a user says what to detect.
struct FeatureArguments {
  std::string settings;
  std::optional<std::string> features;
  std::optional<int> max_features;
  std::vector<std::string> changes;  ///< KEY=VALUE.
};

/// Adds --features, --max-features, --settings and --set. `otherwise` says what holds without them.
void add_feature_arguments(CLI::App* command, FeatureArguments& arguments, const std::string& otherwise);

/// Adds all of them but --features.
void add_feature_option_arguments(CLI::App* command, FeatureArguments& arguments, const std::string& otherwise);

/// What the user asks for: the settings file or else `base`, then --features, then --max-features, then --set. A threshold
/// belongs to its detector and is dropped when --features gives another. Throws InputError.
FeatureOptions asked_features(const FeatureArguments& arguments, const FeatureOptions& base = {});

/// Checks that a text names features, for CLI11.
std::string check_feature_kind(const std::string& text);

}  // namespace fabloop::apps
