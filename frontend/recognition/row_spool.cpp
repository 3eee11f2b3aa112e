// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/recognition/row_spool.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "frontend/error.h"

namespace fabloop {

RowSpool::RowSpool(std::filesystem::path path) : path_(std::move(path)) {
  file_.open(path_, std::ios::binary | std::ios::in | std::ios::out | std::ios::trunc);
  if (!file_) throw InputError(path_.string() + ": cannot be written; choose another place");
}

RowSpool::~RowSpool() {
  file_.close();
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void RowSpool::add_row(std::span<const double> row) {
  const std::size_t length = row.size();
  file_.write(reinterpret_cast<const char*>(&length), sizeof(length));
  file_.write(reinterpret_cast<const char*>(row.data()), static_cast<std::streamsize>(row.size_bytes()));
  if (!file_) throw InputError(path_.string() + ": could not be written; free some space and run again");
  ++num_rows_;
  max_length_ = std::max(max_length_, length);
}

void RowSpool::for_each_row(const std::function<void(std::size_t index, std::span<const double> row)>& body) {
  file_.flush();
  file_.seekg(0);
  std::vector<double> row(max_length_);
  for (std::size_t index = 0; index < num_rows_; ++index) {
    std::size_t length = 0;
    file_.read(reinterpret_cast<char*>(&length), sizeof(length));
    if (file_ && length <= max_length_) {
      file_.read(reinterpret_cast<char*>(row.data()), static_cast<std::streamsize>(length * sizeof(double)));
    }
    if (!file_ || length > max_length_) throw InputError(path_.string() + ": could not be read back; run again on another disk");
    body(index, {row.data(), length});
  }
  file_.seekp(0, std::ios::end);
}

}  // namespace fabloop
