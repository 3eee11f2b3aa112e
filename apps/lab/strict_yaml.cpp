// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/strict_yaml.h"

#include <charconv>
#include <cmath>
#include <set>
#include <sstream>

namespace fabloop {
namespace {

template <typename Number>
bool parse(const std::string& text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

void read_yaml_map(const YamlFile& file, const YAML::Node& node, const std::string& what, const YamlKeys& keys) {
  if (!node.IsMap()) file.fail(node.Mark(), what + " must be a map of keys and values");
  std::set<std::string> seen;
  for (const auto& entry : node) {
    const std::string key = yaml_text(file, entry.first, "a key");
    const auto found = keys.find(key);
    if (found == keys.end()) {
      std::string known;
      for (const auto& [name, read] : keys) known += (known.empty() ? "" : ", ") + name;
      file.fail(entry.first.Mark(), "'" + key + "' is no key of " + what + "; it knows " + known);
    }
    if (!seen.insert(key).second) file.fail(entry.first.Mark(), "'" + key + "' comes twice in " + what);
    found->second(entry.second);
  }
}

std::string yaml_text(const YamlFile& file, const YAML::Node& node, const std::string& what) {
  if (!node.IsScalar() || node.Scalar().empty()) file.fail(node.Mark(), what + " must be a text or number");
  return node.Scalar();
}

double yaml_number(const YamlFile& file, const YAML::Node& node, const std::string& what, double low, double high) {
  const std::string text = yaml_text(file, node, what);
  double value = 0.0;
  if (!parse(text, value) || !std::isfinite(value)) file.fail(node.Mark(), "'" + text + "' is no number for " + what);
  if (value >= low && value <= high) return value;
  std::ostringstream range;
  range << what << " is " << text << ", but must be in [" << low << ", " << high << ']';
  file.fail(node.Mark(), range.str());
}

std::uint64_t yaml_whole_number(const YamlFile& file, const YAML::Node& node, const std::string& what) {
  const std::string text = yaml_text(file, node, what);
  std::uint64_t value = 0;
  if (!parse(text, value)) file.fail(node.Mark(), "'" + text + "' is no whole number for " + what);
  return value;
}

std::vector<YAML::Node> yaml_list(const YamlFile& file, const YAML::Node& node, const std::string& what) {
  if (!node.IsSequence() || node.size() == 0) file.fail(node.Mark(), what + " must be a list that is not empty");
  return {node.begin(), node.end()};
}

}  // namespace fabloop
