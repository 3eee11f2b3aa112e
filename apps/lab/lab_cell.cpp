// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/lab_cell.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <iomanip>
#include <limits>
#include <set>
#include <sstream>
#include <string_view>

#include "frontend/checksum.h"
#include "frontend/error.h"
#include "frontend/features/feature_settings.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

/// Raise it with every change of the program that changes what a cell comes to (features, methods, verification, mapper, back
/// ends, troubles, synthetic worlds, rules of truth, form of a cell's file), so that cells of before are made anew. Within one
/// version of fabloop nothing else notices.
constexpr int kResultVersion = 4;

constexpr std::array<std::string_view, 8> kTextFiles = {".csv", ".g2o", ".json", ".tum", ".txt", ".xml", ".yaml", ".yml"};

std::uint64_t checksum_of_file(const fs::path& path, const std::string& what) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  // An empty file gives no character, which the stream calls a failure.
  std::error_code error;
  if (!file || (!bytes && fs::file_size(path, error) > 0))
    throw InputError(path.string() + ": " + what + " cannot be read; does the file exist?");
  return checksum(bytes.str());
}

/// Text by its contents; of images and whatever else is large, size and time of the last change.
std::string state_of(const fs::directory_entry& file) {
  if (std::find(kTextFiles.begin(), kTextFiles.end(), file.path().extension().string()) != kTextFiles.end())
    return "checksum " + std::to_string(checksum_of_file(file.path(), "a file of the sequence"));
  return std::to_string(file.file_size()) + " bytes, changed " +
         std::to_string(file.last_write_time().time_since_epoch().count());
}

/// All files below a folder, those of linked folders too, and the state of each.
void list_files(std::ostream& out, const fs::path& folder) {
  std::error_code error;
  std::vector<std::string> lines;
  constexpr auto kFollow = fs::directory_options::follow_directory_symlink;
  for (auto file = fs::recursive_directory_iterator(folder, kFollow, error); !error && file != fs::end(file);
       file.increment(error)) {
    if (!file->is_regular_file()) continue;
    lines.push_back(file->path().lexically_relative(folder).generic_string() + ' ' + state_of(*file));
  }
  if (error) throw InputError(folder.string() + ": the sequence cannot be read: " + error.message());
  std::sort(lines.begin(), lines.end());
  for (const std::string& line : lines) out << line << '\n';
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// As few digits as tell the number from all others: 0.3.
std::string shortest_text(double value) {
  std::array<char, 32> text{};
  const std::to_chars_result end = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end.ptr};
}

/// Every combination of the swept values, the first parameter outermost.
std::vector<LabCell> swept_cells(const LabDescription& description) {
  LabCell first;
  first.settings = description.settings;
  std::vector<LabCell> cells = {first};
  for (const LabSweep& sweep : description.sweep) {
    std::vector<LabCell> more;
    for (const LabCell& cell : cells) {
      for (const double value : sweep.values) {
        more.push_back(cell);
        more.back().swept.emplace_back(sweep.parameter->name, value);
        sweep.parameter->of(more.back().settings) = value;
      }
    }
    cells = std::move(more);
  }
  return cells;
}

/// Throws InputError where there is no such folder.
fs::path folder_of_sequence(const std::string& name, const LabDescription& description, const fs::path& data_root) {
  const fs::path folder = data_root / name;
  if (fs::is_directory(folder)) return folder;
  throw InputError(folder.string() + ": there is no such sequence, which " + description.path.string() +
                   " names; say with --data where its folders are");
}

}  // namespace

std::string LabCell::group() const {
  std::ostringstream text;
  text << data;
  for (const auto& [name, value] : swept) text << ", " << name << ' ' << value;
  return text.str();
}

std::string name_of_folder(const fs::path& folder) {
  const fs::path path = folder.lexically_normal();
  return (path.has_filename() ? path.filename() : path.parent_path().filename()).string();
}

std::vector<LabCell> cells_of(const LabDescription& description, const fs::path& data_root) {
  std::vector<LabCell> cells;
  std::set<std::string> names;
  const auto add = [&](const std::string& data, const fs::path& folder, const fs::path& earlier, double height_m) {
    if (!names.insert(data).second) throw InputError(description.path.string() + ": two sequences are called " + data);
    for (LabCell cell : swept_cells(description)) {
      cell.data = data;
      cell.folder = folder;
      cell.earlier_folder = earlier;
      cell.height_above_ground_m = height_m;
      for (const std::uint64_t seed : description.seeds) {
        cell.seed = seed;
        cell.settings.trouble.seed = seed;
        cells.push_back(cell);
      }
    }
  };
  if (description.synthetic) add("synthetic", {}, {}, description.synthetic->mean_height_m);
  for (const SequenceData& sequence : description.sequences) {
    const fs::path folder = folder_of_sequence(sequence.folder, description, data_root);
    if (sequence.earlier.empty()) {
      add(name_of_folder(folder), folder, {}, sequence.height_above_ground_m);
      continue;
    }
    const fs::path earlier = folder_of_sequence(sequence.earlier, description, data_root);
    if (fs::equivalent(folder, earlier))
      throw InputError(folder.string() + ": cannot come after itself, since all pairs across two flights count as false");
    add(name_of_folder(folder) + " after " + name_of_folder(earlier), folder, earlier, sequence.height_above_ground_m);
  }
  return cells;
}

fs::path scores_file(const LabMethod& method, const LabCell& cell, const LabDescription& description) {
  if (method.method) return {};
  std::string path = method.scores;
  replace_all(path, "{data}", cell.data);
  replace_all(path, "{seed}", std::to_string(cell.seed));
  LabSettings settings = cell.settings;
  for (const LabParameter& parameter : lab_parameters())
    replace_all(path, '{' + std::string(parameter.name) + '}', shortest_text(parameter.of(settings)));
  return description.path.parent_path() / path;
}

std::string cell_text(const LabCell& cell, const LabDescription& description) {
  std::ostringstream text;
  text << std::setprecision(std::numeric_limits<double>::max_digits10) << "fabloop " << FABLOOP_VERSION << ", results "
       << kResultVersion << "\ndata " << cell.data << ' ' << cell.height_above_ground_m << "\nseed " << cell.seed << '\n';
  if (description.synthetic) {
    const SyntheticData& data = *description.synthetic;
    for (const double value : {data.length_m, data.spacing_m, data.mean_height_m, data.height_spread_m, data.max_strip_gap_m,
                               data.texture_m_per_px, data.height_m_per_px, data.camera_scale, data.tile_m})
      text << value << ' ';
    text << '\n';
  } else {
    list_files(text, cell.folder);
    if (!cell.earlier_folder.empty()) {
      text << "after\n";
      list_files(text, cell.earlier_folder);
    }
  }
  LabSettings settings = cell.settings;
  for (const LabParameter& parameter : lab_parameters()) text << parameter.name << ' ' << parameter.of(settings) << '\n';
  for (const LabMethod& method : description.methods) {
    text << "method " << method.name;
    if (!method.method) text << ' ' << checksum_of_file(scores_file(method, cell, description), "the scores");
    text << '\n';
  }
  text << "verifies " << description.verifies() << '\n';
  for (const LabBackEnd& back_end : description.back_ends) text << "back end " << back_end.name << '\n';
  text << feature_options_json(description.features) << '\n';
  return text.str();
}

std::string cell_checksum(const LabCell& cell, const LabDescription& description) {
  std::ostringstream text;
  text << std::hex << std::setfill('0') << std::setw(16) << checksum(cell_text(cell, description));
  return text.str();
}

}  // namespace fabloop
