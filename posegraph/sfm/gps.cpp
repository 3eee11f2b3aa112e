// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/gps.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "frontend/error.h"
#include "frontend/sequence/exif.h"
#include "posegraph/sfm/geodesy.h"
#include "verification/median.h"

namespace fabloop {
namespace {

std::optional<double> number(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return std::nullopt;
  text = text.substr(first, text.find_last_not_of(" \t\r") + 1 - first);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<GeoPosition> parse(std::string_view numbers) {
  std::vector<double> values;
  while (values.size() < 4) {
    const auto comma = numbers.find(',');
    const auto value = number(numbers.substr(0, comma));
    if (!value) return std::nullopt;
    values.push_back(*value);
    if (comma == std::string_view::npos) break;
    numbers.remove_prefix(comma + 1);
  }
  if (values.size() != 3 || std::abs(values[0]) > 90.0 || std::abs(values[1]) > 360.0) return std::nullopt;
  return GeoPosition{values[0], values[1], values[2]};
}

}  // namespace

std::vector<std::optional<GeoPosition>> read_gps(const std::filesystem::path& path, const Sequence& sequence) {
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": the GPS file cannot be read; does it exist?");
  std::map<std::string, GeoPosition> by_name;
  std::string line;
  for (std::size_t number_of_line = 1; std::getline(file, line); ++number_of_line) {
    if (line.empty() || line.front() == '#' || line == "\r") continue;
    const auto comma = line.find(',');
    const auto position = comma == std::string::npos ? std::nullopt : parse(std::string_view(line).substr(comma + 1));
    if (!position) {
      throw InputError(path.string() + ":" + std::to_string(number_of_line) +
                       ": is no line 'filename,latitude_deg,longitude_deg,altitude_m'");
    }
    by_name[line.substr(0, comma)] = *position;
  }
  std::vector<std::optional<GeoPosition>> positions;
  for (const Frame& frame : sequence.frames) {
    const auto at = by_name.find(frame.image_path.filename().string());
    positions.push_back(at == by_name.end() ? std::nullopt : std::optional(at->second));
  }
  if (std::none_of(positions.begin(), positions.end(), [](const auto& p) { return p.has_value(); })) {
    throw InputError(path.string() + ": names none of the images of " + sequence.name + "; is it of another flight?");
  }
  return positions;
}

std::vector<std::optional<GeoPosition>> gps_from_exif(const Sequence& sequence) {
  std::vector<std::optional<GeoPosition>> positions;
  for (const Frame& frame : sequence.frames) positions.push_back(position_from_exif(frame.image_path));
  return positions;
}

LocalPositions local_positions(const std::vector<std::optional<GeoPosition>>& positions) {
  LocalPositions local;
  local.east_north_up_m.resize(positions.size());
  const auto middle = [&](double GeoPosition::*coordinate) {
    std::vector<double> values;
    for (const auto& position : positions) {
      if (position) values.push_back((*position).*coordinate);
    }
    return median(std::move(values));
  };
  local.origin = {middle(&GeoPosition::latitude_deg), middle(&GeoPosition::longitude_deg), middle(&GeoPosition::altitude_m)};
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (positions[i]) local.east_north_up_m[i] = local_from_geo(local.origin, *positions[i]);
  }
  return local;
}

}  // namespace fabloop
