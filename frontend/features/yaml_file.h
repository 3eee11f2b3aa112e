// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>

namespace fabloop {

/// A YAML document and the file it stands in, for messages.
struct YamlFile {
  std::filesystem::path path;
  YAML::Node root;
  std::string text;  ///< The file's bytes.

  /// Throws InputError with the file and the line of the mark.
  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& what) const;
};

/// Reads a settings file, whose root is a map. Takes OpenCV's head `%YAML:1.0` too. Throws InputError.
YamlFile read_yaml_file(const std::filesystem::path& path);

}  // namespace fabloop
