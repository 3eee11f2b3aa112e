// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/loop_matrix.h"

#include <algorithm>
#include <fstream>
#include <string>

#include "frontend/error.h"
#include "frontend/npy.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

constexpr const char* kForm = "; a loop matrix has a 1 where query (row) and match (column) show the same place, else 0";

LoopMatrix read_npy_matrix(const fs::path& path) {
  NpyReader reader(path);
  LoopMatrix matrix{reader.num_rows(), reader.num_columns(), {}};
  matrix.entries.reserve(matrix.num_queries * matrix.num_matches);
  std::vector<double> row(matrix.num_matches);
  for (std::size_t query = 0; query < matrix.num_queries; ++query) {
    reader.read_row(row);
    for (std::size_t match = 0; match < row.size(); ++match) {
      if (row[match] != 0.0 && row[match] != 1.0) {
        throw InputError(path.string() + ": the entry in row " + std::to_string(query) + ", column " + std::to_string(match) +
                         " is neither 0 nor 1" + kForm);
      }
      matrix.entries.push_back(row[match] != 0.0);
    }
  }
  return matrix;
}

/// Appends a line's entries; the error, if there is one.
std::string append_row(const std::string& line, std::vector<std::uint8_t>& entries) {
  constexpr const char* kApart = " \t\r,;";
  for (std::size_t begin = 0; (begin = line.find_first_not_of(kApart, begin)) != std::string::npos;) {
    const std::size_t end = std::min(line.find_first_of(kApart, begin), line.size());
    const std::string entry = line.substr(begin, end - begin);
    const bool is_one = entry == "1" || entry == "1.0" || entry == "true";
    if (!is_one && entry != "0" && entry != "0.0" && entry != "false") return "'" + entry + "' is neither 0 nor 1";
    entries.push_back(is_one);
    begin = end;
  }
  return {};
}

LoopMatrix read_text_matrix(const fs::path& path) {
  std::ifstream file(path);
  if (!file || fs::is_directory(path)) throw InputError(path.string() + ": cannot be read; does the file exist?");
  LoopMatrix matrix;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const auto fail = [&](const std::string& what) {
      throw InputError(path.string() + ":" + std::to_string(number) + ": " + what + kForm);
    };
    if (line.find_first_not_of(" \t\r") == std::string::npos || line.front() == '#') continue;
    const std::size_t before = matrix.entries.size();
    const std::string problem = append_row(line, matrix.entries);
    if (!problem.empty()) fail(problem);
    const std::size_t length = matrix.entries.size() - before;
    if (matrix.num_queries == 0) matrix.num_matches = length;
    if (length != matrix.num_matches) {
      fail("has " + std::to_string(length) + " entries, but the first row has " + std::to_string(matrix.num_matches));
    }
    ++matrix.num_queries;
  }
  if (matrix.entries.empty()) throw InputError(path.string() + ": has no entries" + kForm);
  return matrix;
}

}  // namespace

LoopMatrix read_loop_matrix(const fs::path& path) {
  return path.extension() == ".npy" ? read_npy_matrix(path) : read_text_matrix(path);
}

}  // namespace fabloop
