// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>

namespace fabloop {

/// Rows of different lengths, kept in a file until it is known how long the longest is. The file goes with the object.
class RowSpool {
 public:
  /// Throws InputError when the file cannot be created.
  explicit RowSpool(std::filesystem::path path);
  ~RowSpool();
  RowSpool(const RowSpool&) = delete;
  RowSpool& operator=(const RowSpool&) = delete;

  /// Throws InputError when the disk is full.
  void add_row(std::span<const double> row);

  /// Calls `body` with each row in turn; may be called again. Throws InputError when the file cannot be read back.
  void for_each_row(const std::function<void(std::size_t index, std::span<const double> row)>& body);

  std::size_t num_rows() const { return num_rows_; }
  std::size_t max_length() const { return max_length_; }

 private:
  std::filesystem::path path_;
  std::fstream file_;
  std::size_t num_rows_ = 0;
  std::size_t max_length_ = 0;
};

}  // namespace fabloop
