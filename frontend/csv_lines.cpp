// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/csv_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <system_error>
#include <utility>

#include "frontend/error.h"

namespace fabloop {
namespace {

CsvFields split(const std::string& line) {
  CsvFields fields;
  for (std::size_t start = 0; start <= line.size();) {
    const std::size_t comma = std::min(line.find(',', start), line.size());
    std::string field = line.substr(start, comma - start);
    field.erase(0, field.find_first_not_of(" \t\r"));
    field.erase(field.find_last_not_of(" \t\r") + 1);
    fields.push_back(std::move(field));
    start = comma + 1;
  }
  return fields;
}

}  // namespace

void for_each_csv_line(const std::filesystem::path& path, const std::function<void(const CsvFields&, const CsvFail&)>& read) {
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": cannot be read; does the file exist?");
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos || line.front() == '#') continue;
    const CsvFail fail = [&](const std::string& what) {
      throw InputError(path.string() + ":" + std::to_string(number) + ": " + what);
    };
    read(split(line), fail);
  }
}

std::size_t parse_position(const std::string& text, const CsvFail& fail) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    fail("'" + text + "' is not a whole number; give a position from 0");
  return value;
}

double parse_number(const std::string& text, const CsvFail& fail) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    fail("'" + text + "' is not a finite number; correct or remove the line");
  }
  return value;
}

}  // namespace fabloop
