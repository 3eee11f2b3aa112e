// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/frames_csv.h"

#include <fstream>
#include <string_view>

#include "frontend/error.h"
#include "frontend/sequence/trajectory.h"

namespace fabloop {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\"";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

bool is_header(std::string_view first_column) {
  return first_column == "filename" || first_column == "file" || first_column == "image" || first_column == "name";
}

}  // namespace

std::vector<StampedImage> read_frames_csv(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": cannot be read; is it a file that you may read?");
  std::vector<StampedImage> images;
  std::string text;
  for (int line_number = 1; std::getline(file, text); ++line_number) {
    const auto fail = [&](const std::string& what) {
      throw InputError(path.string() + ":" + std::to_string(line_number) + ": " + what + "; a line is 'filename,timestamp_s'");
    };
    std::string_view line = text;
    if (line_number == 1 && line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
    line = trimmed(line);
    if (line.empty() || line.front() == '#') continue;
    const std::size_t comma = line.find(',');
    const std::string filename(trimmed(line.substr(0, comma)));
    if (images.empty() && is_header(filename)) continue;
    if (comma == std::string_view::npos) fail("has no comma");
    if (filename.empty()) fail("has no file name");
    const std::string_view rest = line.substr(comma + 1);
    const std::string stamp(trimmed(rest.substr(0, rest.find(','))));
    const auto time_ns = nanoseconds_from_seconds(stamp);
    if (!time_ns) fail("'" + stamp + "' is not a time in seconds");
    if (!images.empty() && *time_ns <= images.back().time_ns) fail("the time of '" + filename + "' does not ascend");
    images.push_back({filename, *time_ns, line_number});
  }
  if (images.empty()) throw InputError(path.string() + ": lists no images; a line is 'filename,timestamp_s'");
  return images;
}

}  // namespace fabloop
