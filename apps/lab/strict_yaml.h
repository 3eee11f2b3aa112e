// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "frontend/features/yaml_file.h"

namespace fabloop {

/// What to do with the value of each key that a map may have.
using YamlKeys = std::map<std::string, std::function<void(const YAML::Node& value)>>;

/// Hands every value to its key's function. Throws InputError with file and line when `node` is no map, for a key that is not in
/// `keys` (naming those that are), and for one that comes twice. `what` names the map.
void read_yaml_map(const YamlFile& file, const YAML::Node& node, const std::string& what, const YamlKeys& keys);

/// Scalars; throw InputError with file and line for anything else, and for numbers outside [low, high].
std::string yaml_text(const YamlFile& file, const YAML::Node& node, const std::string& what);
double yaml_number(const YamlFile& file, const YAML::Node& node, const std::string& what, double low, double high);
std::uint64_t yaml_whole_number(const YamlFile& file, const YAML::Node& node, const std::string& what);

/// The entries of a list that is not empty; throws InputError likewise.
std::vector<YAML::Node> yaml_list(const YamlFile& file, const YAML::Node& node, const std::string& what);

}  // namespace fabloop
