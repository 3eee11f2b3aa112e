// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/feature_settings.h"

#include <yaml-cpp/yaml.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <type_traits>

#include "frontend/error.h"
#include "frontend/features/feature_option_list.h"
#include "frontend/features/option_text.h"
#include "frontend/features/yaml_file.h"
#include "frontend/output_file.h"

namespace fabloop {
namespace {

using Json = nlohmann::ordered_json;

/// A key's section and the name in it; an empty section for those that stand for themselves.
struct KeyParts {
  std::string section, name;
};

KeyParts parts_of(const std::string& key) {
  const std::size_t dot = key.find('.');
  return dot == std::string::npos ? KeyParts{"", key} : KeyParts{key.substr(0, dot), key.substr(dot + 1)};
}

bool is_section(const std::string& name) {
  FeatureOptions all;
  all.adaptive.emplace();
  bool found = false;
  for_each_option(all, [&](const std::string& key, const auto&, const char*) { found |= parts_of(key).section == name; });
  return found;
}

/// Sets the option `key`; returns what a value would be, where the text is none, and "" otherwise.
std::string set_option(FeatureOptions& options, const std::string& key, const std::string& text) {
  std::string problem = "nothing: there is no such option";
  for_each_option(options, [&](const std::string& name, auto& field, const char*) {
    if (name != key) return;
    const auto parsed = parse_option(text, field);
    problem = parsed.value ? "" : parsed.expected;
    if (parsed.value) field = *parsed.value;
  });
  return problem;
}

bool is_option(const std::string& key) {
  FeatureOptions all;
  all.adaptive.emplace();
  bool found = false;
  for_each_option(all, [&](const std::string& name, const auto&, const char*) { found |= name == key; });
  return found;
}

void read_value(const YamlFile& file, const YAML::Node& key, const YAML::Node& value, const std::string& section,
                FeatureOptions& options) {
  const std::string name = (section.empty() ? "" : section + ".") + key.as<std::string>();
  if (!is_option(name))
    file.fail(key.Mark(), "'" + name + "' is no option of features; `fabloop features --print-settings` shows all");
  const std::string text = value.IsNull() ? "none" : value.IsScalar() ? value.Scalar() : "a list";
  const std::string expected = set_option(options, name, text);
  if (!expected.empty()) file.fail(key.Mark(), name + " is '" + text + "'; give " + expected);
}

void read_section(const YamlFile& file, const YAML::Node& key, const YAML::Node& value, FeatureOptions& options) {
  const auto section = key.as<std::string>();
  const bool is_none = value.IsNull() || (value.IsScalar() && value.Scalar() == "none");
  if (section == "adaptive") {
    options.adaptive.reset();
    if (is_none) return;
    options.adaptive.emplace();
  }
  if (!value.IsMap()) file.fail(key.Mark(), section + " is a section: give its options, indented, below it");
  for (const auto& entry : value) read_value(file, entry.first, entry.second, section, options);
}

/// Options that matter to a kind: those of no section, of its detector and of its descriptor.
bool matters(const std::string& key, const FeatureKind& kind) {
  const std::string section = parts_of(key).section;
  return section.empty() || section == "adaptive" || section == to_string(kind.detector) || section == to_string(kind.descriptor);
}

struct OptionText {
  std::string option, text;
};

/// The options that matter, the threshold as it holds.
std::vector<OptionText> texts_of(const FeatureOptions& options) {
  std::vector<OptionText> texts;
  FeatureOptions explicit_options = options;
  explicit_options.detection_threshold = detection_threshold(options);
  for_each_option(explicit_options, [&](const std::string& key, const auto& field, const char*) {
    if (matters(key, options.kind)) texts.push_back({key, option_text(field)});
  });
  return texts;
}

template <typename Value>
Json json_of(const Value& value) {
  const std::string text = option_text(value);
  if constexpr (std::is_same_v<Value, FeatureKind> || std::is_same_v<Value, Orientation>) return text;
  return text == "none" ? Json() : Json::parse(text);
}

/// The value of an option in a JSON object; null where there is none.
const Json* find_value(const Json& json, const KeyParts& parts) {
  const Json* object = &json;
  if (!parts.section.empty()) {
    const auto section = json.find(parts.section);
    if (section == json.end() || !section->is_object()) return nullptr;
    object = &*section;
  }
  const auto value = object->find(parts.name);
  return value == object->end() ? nullptr : &*value;
}

}  // namespace

FeatureOptions read_feature_settings(const std::filesystem::path& path) {
  const YamlFile file = read_yaml_file(path);
  if (file.root["FeatureOptions"].IsDefined()) return read_openfabmap_features(path);
  FeatureOptions options;
  try {
    for (const auto& top : file.root) {
      if (top.first.as<std::string>() != "features")
        file.fail(top.first.Mark(), "'" + top.first.as<std::string>() + "' is no section of a settings file; `features` is");
      if (!top.second.IsMap()) file.fail(top.first.Mark(), "features is a section: give its options, indented, below it");
      for (const auto& entry : top.second) {
        if (is_section(entry.first.as<std::string>())) {
          read_section(file, entry.first, entry.second, options);
        } else {
          read_value(file, entry.first, entry.second, "", options);
        }
      }
    }
  } catch (const YAML::Exception& error) {
    file.fail(error.mark, error.msg);
  }
  try {
    validate(options);
  } catch (const InputError& error) {
    throw InputError(path.string() + ": " + error.what());
  }
  return options;
}

void set_feature_option(FeatureOptions& options, const std::string& key, const std::string& value) {
  if (key == "adaptive" && value == "none") return options.adaptive.reset();
  if (!is_option(key)) throw InputError("'" + key + "' is no option of features; `fabloop features --print-settings` shows all");
  if (parts_of(key).section == "adaptive" && !options.adaptive) options.adaptive.emplace();
  const std::string expected = set_option(options, key, value);
  if (!expected.empty()) throw InputError(key + " is '" + value + "'; give " + expected);
}

std::string feature_settings_text(const FeatureOptions& options) {
  std::ostringstream text;
  text << "# Settings of fabloop (--settings FILE). What is left out has its default.\n"
       << "# detectors: " << detector_names() << "\n# descriptors: " << descriptor_names() << "\nfeatures:\n";
  std::string section;
  for_each_option(options, [&](const std::string& key, const auto& field, const char* documentation) {
    const KeyParts parts = parts_of(key);
    if (parts.section != section) text << "  " << parts.section << ":\n";
    section = parts.section;
    text << (section.empty() ? "  " : "    ") << parts.name << ": " << option_text(field) << "  # " << documentation << '\n';
    if (key == "orientation" && !options.adaptive)
      text << "  adaptive: none  # or min_features, max_features: steer the threshold to a number of features\n";
  });
  return text.str();
}

void write_feature_settings(const std::filesystem::path& path, const FeatureOptions& options) {
  OutputFile file(path);
  file.stream() << feature_settings_text(options);
  file.commit();
}

std::string feature_options_json(const FeatureOptions& options) {
  Json json;
  for_each_option(options, [&](const std::string& key, const auto& field, const char*) {
    const KeyParts parts = parts_of(key);
    (parts.section.empty() ? json : json[parts.section])[parts.name] = json_of(field);
  });
  return json.dump();
}

FeatureOptions feature_options_from_json(std::string_view text) {
  FeatureOptions options;
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) throw InputError("feature options: no JSON object");
  if (json.contains("adaptive")) options.adaptive.emplace();
  // Of a version that looked at images as they are.
  if (!json.contains("max_side_px")) options.max_side_px = kLargestSidePx;
  std::size_t num_read = 0, num_values = 0;
  for_each_option(options, [&](const std::string& key, auto& field, const char*) {
    const Json* value = find_value(json, parts_of(key));
    if (!value) return;
    ++num_read;
    const std::string text_value = value->is_string() ? value->get<std::string>() : value->dump();
    const auto parsed = parse_option(text_value, field);
    if (!parsed.value) throw InputError("feature options: " + key + " is " + text_value + "; expected " + parsed.expected);
    field = *parsed.value;
  });
  for (const Json& value : json) num_values += value.is_object() ? value.size() : 1;
  if (num_values != num_read) throw InputError("feature options: there are some that are not known");
  validate(options);
  return options;
}

std::optional<OptionDifference> first_difference(const FeatureOptions& a, const FeatureOptions& b) {
  if (a.adaptive.has_value() != b.adaptive.has_value())
    return OptionDifference{"adaptive", a.adaptive ? "on" : "off", b.adaptive ? "on" : "off"};
  if (a.kind != b.kind) return OptionDifference{"kind", to_string(a.kind), to_string(b.kind)};
  const std::vector<OptionText> of_a = texts_of(a), of_b = texts_of(b);
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    if (of_a[i].text != of_b[i].text) return OptionDifference{of_a[i].option, of_a[i].text, of_b[i].text};
  }
  return std::nullopt;
}

}  // namespace fabloop
