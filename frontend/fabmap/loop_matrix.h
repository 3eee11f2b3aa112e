// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace fabloop {

/// Which frames show the same place, as the Oxford data sets have it: one where they do.
struct LoopMatrix {
  std::size_t num_queries = 0;
  std::size_t num_matches = 0;
  std::vector<std::uint8_t> entries;  ///< 0 or 1, num_queries x num_matches, row by row.

  bool at(std::size_t query, std::size_t match) const { return entries[query * num_matches + match] != 0; }
};

/// Reads a matrix of 0 and 1: a NumPy file (`.npy`, any type), or text with a row a line, entries apart by blanks, commas or
/// semicolons, `#` comments. Throws InputError naming the file (and line) for any other entry and for rows that differ in length.
LoopMatrix read_loop_matrix(const std::filesystem::path& path);

}  // namespace fabloop
