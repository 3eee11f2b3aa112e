// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

#include "frontend/output_file.h"

namespace fabloop {

/// What the entries of a NumPy file are.
enum class NpyType { Float64, Float32, UInt8, Int8, Bool, UInt16, Int16, UInt32, Int32, UInt64, Int64 };

/// Writes a matrix as a NumPy file (format 1.0, little-endian, row by row), so that it need not stand in memory. The file
/// appears only with commit().
class NpyWriter {
 public:
  /// Float64, Float32 or UInt8. Throws InputError when the file cannot be created.
  NpyWriter(const std::filesystem::path& path, NpyType type, std::size_t num_columns);

  /// The next row. One shorter than num_columns is filled up with `fill`.
  void add_row(std::span<const double> row, double fill = 0.0);

  /// Completes header and file. Throws InputError when anything could not be written.
  void commit();

 private:
  void write_header();

  OutputFile file_;
  NpyType type_;
  std::size_t num_columns_;
  std::size_t num_rows_ = 0;
  std::vector<char> bytes_;  ///< Of one row.
};

/// Reads a matrix from a NumPy file row by row, whatever its entries' type.
class NpyReader {
 public:
  /// Throws InputError when the file is missing, of another kind, not a little-endian matrix stored by rows, or shorter or
  /// longer than its shape says.
  explicit NpyReader(const std::filesystem::path& path);

  std::size_t num_rows() const { return num_rows_; }
  std::size_t num_columns() const { return num_columns_; }
  NpyType type() const { return type_; }

  /// The next row; `row` has num_columns() entries, and there must be one left. Throws InputError when it cannot be read.
  void read_row(std::span<double> row);

 private:
  std::filesystem::path path_;
  std::ifstream file_;
  NpyType type_ = NpyType::Float64;
  std::size_t num_rows_ = 0;
  std::size_t num_columns_ = 0;
  std::vector<char> bytes_;  ///< Of one row.
};

}  // namespace fabloop
