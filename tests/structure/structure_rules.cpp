// SPDX-License-Identifier: BSD-3-Clause
#include "tests/structure/structure_rules.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <string_view>

namespace fabloop {
namespace {

namespace fs = std::filesystem;

using Folders = std::set<std::string>;

/// Which folders a folder's files may include; tests may include all.
const std::map<std::string, Folders>& allowed_folders() {
  static const std::map<std::string, Folders> allowed{
      {"frontend", {"frontend"}},
      {"verification", {"frontend", "verification"}},
      {"posegraph", {"frontend", "verification", "posegraph"}},
      {"data", {"frontend", "data"}},
      {"apps", {"frontend", "verification", "posegraph", "data", "apps"}},
      {"tests", {"frontend", "verification", "posegraph", "data", "apps", "tests"}},
  };
  return allowed;
}

struct SourceFile {
  fs::path path;  ///< From the root.
  std::vector<std::string> lines;

  std::string folder() const { return path.begin()->string(); }
  bool is_header() const { return path.extension() == ".h"; }
  bool is_library() const { return folder() != "apps" && folder() != "tests"; }
};

class Report {
 public:
  void add(const SourceFile& file, std::size_t line, const std::string& what) {
    lines.push_back(file.path.generic_string() + ":" + std::to_string(line + 1) + ": " + what);
  }
  std::vector<std::string> lines;
};

/// What stands between the quotes or brackets of an #include line; empty for other lines.
std::string_view included(std::string_view line, char open, char close) {
  constexpr std::string_view kInclude = "#include ";
  if (!line.starts_with(kInclude) || line.size() <= kInclude.size() || line[kInclude.size()] != open) return {};
  line.remove_prefix(kInclude.size() + 1);
  return line.substr(0, line.find(close));
}

void check_include(const fs::path& root, const SourceFile& file, std::size_t line, Report& report) {
  const std::string own(included(file.lines[line], '"', '"'));
  if (!own.empty()) {
    const std::string folder = fs::path(own).begin()->string();
    if (!fs::exists(root / own)) {
      report.add(file, line, "'" + own + "' is no path from the root");
    } else if (!allowed_folders().at(file.folder()).contains(folder)) {
      report.add(file, line, file.folder() + " may not include " + folder);
    }
  }
  const std::string_view other = included(file.lines[line], '<', '>');
  const bool is_source = file.path.extension() == ".cpp";
  const bool may_opengv = (file.folder() == "verification" && is_source) || file.folder() == "tests";
  const bool may_ceres =
      (file.folder() == "posegraph" && (is_source || file.path.generic_string().starts_with("posegraph/residuals/"))) ||
      file.folder() == "tests";
  if (other.starts_with("opengv/") && !may_opengv) report.add(file, line, "OpenGV belongs in verification's .cpp files");
  if (other.starts_with("ceres/") && !may_ceres) report.add(file, line, "Ceres belongs in posegraph's .cpp files and residuals/");
  if (other == "iostream" && file.is_library()) report.add(file, line, "the library does not print");
}

void check_file(const fs::path& root, const SourceFile& file, Report& report) {
  const auto line_or_empty = [&](std::size_t i) { return i < file.lines.size() ? file.lines[i] : std::string(); };
  if (line_or_empty(0) != "// SPDX-License-Identifier: BSD-3-Clause") report.add(file, 0, "the licence head is missing");
  const bool has_pragma = std::find(file.lines.begin(), file.lines.end(), "#pragma once") != file.lines.end();
  if (file.is_header() && !has_pragma) report.add(file, 0, "'#pragma once' is missing");
  for (std::size_t i = 0; i < file.lines.size(); ++i) {
    check_include(root, file, i, report);
    // Put together here so that this file does not offend itself.
    for (const std::string& mark : {std::string("TO") + "DO", std::string("FIX") + "ME"}) {
      if (file.lines[i].find(mark) != std::string::npos) report.add(file, i, "'" + mark + "' is left");
    }
  }
}

SourceFile read_source(const fs::path& root, const fs::path& path) {
  SourceFile file{fs::relative(path, root), {}};
  std::ifstream stream(path);
  for (std::string line; std::getline(stream, line);) file.lines.push_back(line);
  return file;
}

}  // namespace

std::vector<std::string> structure_violations(const fs::path& root) {
  std::vector<fs::path> paths;
  for (const auto& [folder, allowed] : allowed_folders()) {
    if (!fs::exists(root / folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const fs::path extension = entry.path().extension();
      if (extension == ".h" || extension == ".cpp") paths.push_back(entry.path());
    }
  }
  std::sort(paths.begin(), paths.end());
  Report report;
  for (const fs::path& path : paths) check_file(root, read_source(root, path), report);
  return report.lines;
}

}  // namespace fabloop
