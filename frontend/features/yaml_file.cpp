// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/yaml_file.h"

#include <algorithm>
#include <fstream>
#include <sstream>

#include "frontend/error.h"

namespace fabloop {

void YamlFile::fail(const YAML::Mark& mark, const std::string& what) const {
  std::string where = path.string();
  if (!mark.is_null()) where.append(":").append(std::to_string(mark.line + 1));
  throw InputError(where + ": " + what);
}

YamlFile read_yaml_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream bytes;
  if (!stream || std::filesystem::is_directory(path) || !(bytes << stream.rdbuf())) {
    throw InputError(path.string() + ": cannot be read as settings; does the file exist, and is it not empty?");
  }
  YamlFile file{path, {}, bytes.str()};
  std::string text = file.text;
  // OpenCV's head is no valid YAML directive; its line stays, so that lines keep their numbers.
  if (text.starts_with("%YAML:")) text.erase(0, std::min(text.find('\n'), text.size()));
  try {
    file.root = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    file.fail(error.mark, "is no YAML: " + error.msg);
  }
  if (!file.root.IsMap()) file.fail(YAML::Mark::null_mark(), "holds no settings; a settings file has a section `features`");
  return file;
}

}  // namespace fabloop
