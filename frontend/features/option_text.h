// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "frontend/features/feature_options.h"

namespace fabloop {

/// An option's value as files and messages have it. Numbers have as many digits as they need to come back as they were.
std::string option_text(int value);
std::string option_text(double value);
std::string option_text(bool value);
std::string option_text(const std::optional<double>& value);
std::string option_text(Orientation value);
std::string option_text(const FeatureKind& value);

/// The inverse: none for a text that is no such value, and what would be one.
template <typename Value>
struct ParsedOption {
  std::optional<Value> value;
  std::string expected;  ///< "a whole number"
};

ParsedOption<int> parse_option(const std::string& text, const int& like);
ParsedOption<double> parse_option(const std::string& text, const double& like);
ParsedOption<bool> parse_option(const std::string& text, const bool& like);
ParsedOption<std::optional<double>> parse_option(const std::string& text, const std::optional<double>& like);
ParsedOption<Orientation> parse_option(const std::string& text, const Orientation& like);
ParsedOption<FeatureKind> parse_option(const std::string& text, const FeatureKind& like);

}  // namespace fabloop
