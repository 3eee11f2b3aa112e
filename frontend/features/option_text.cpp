// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/option_text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace fabloop {
namespace {

template <typename Number>
std::string number_text(Number value) {
  std::array<char, 32> digits{};
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), result.ptr};
}

template <typename Number>
std::optional<Number> number_of(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool is_none(const std::string& text) { return text.empty() || text == "none" || text == "null" || text == "~"; }

}  // namespace

std::string option_text(int value) { return number_text(value); }

std::string option_text(double value) { return number_text(value); }

std::string option_text(bool value) { return value ? "true" : "false"; }

std::string option_text(const std::optional<double>& value) { return value ? number_text(*value) : "none"; }

std::string option_text(Orientation value) { return value == Orientation::Upright ? "upright" : "dominant"; }

std::string option_text(const FeatureKind& value) { return to_string(value); }

ParsedOption<int> parse_option(const std::string& text, const int&) { return {number_of<int>(text), "a whole number"}; }

ParsedOption<double> parse_option(const std::string& text, const double&) {
  const std::optional<double> value = number_of<double>(text);
  return {value && std::isfinite(*value) ? value : std::nullopt, "a number"};
}

ParsedOption<bool> parse_option(const std::string& text, const bool&) {
  const std::string expected = "true or false";
  if (text == "true" || text == "on" || text == "yes") return {true, expected};
  if (text == "false" || text == "off" || text == "no") return {false, expected};
  return {std::nullopt, expected};
}

ParsedOption<std::optional<double>> parse_option(const std::string& text, const std::optional<double>&) {
  ParsedOption<std::optional<double>> parsed{std::nullopt, "a number, or none"};
  if (is_none(text)) {
    parsed.value.emplace(std::nullopt);
  } else if (const std::optional<double> value = parse_option(text, double{}).value) {
    parsed.value.emplace(value);
  }
  return parsed;
}

ParsedOption<Orientation> parse_option(const std::string& text, const Orientation&) {
  const std::string expected = "dominant or upright";
  if (text == "dominant") return {Orientation::Dominant, expected};
  if (text == "upright") return {Orientation::Upright, expected};
  return {std::nullopt, expected};
}

ParsedOption<FeatureKind> parse_option(const std::string& text, const FeatureKind&) {
  return {feature_kind_from_string(text),
          "a detector (" + detector_names() + "), or DETECTOR+DESCRIPTOR (" + descriptor_names() + ")"};
}

}  // namespace fabloop
