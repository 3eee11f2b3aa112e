// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <opencv2/core.hpp>

namespace fabloop {

/// The bytes of a file as they lie on disk: mapped where the system can, read otherwise. Pages are read when they are first
/// touched and shared with all who map the same file. Writing to them changes this process's copy, never the file.
///
/// A file replaced by renaming (as OutputFile does) keeps its old bytes here. One that another program shortens in place
/// while it is mapped loses them, and touching them ends the process: copy models beside, then rename.
class MappedFile {
 public:
  /// Throws InputError when the file cannot be read.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept;
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(MappedFile&&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  const std::byte* data() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  std::byte* data_ = nullptr;  ///< At least 64-byte aligned; null for an empty file.
  std::size_t size_ = 0;

  friend cv::Mat matrix_of(MappedFile file, std::size_t offset, int rows, int columns, int type);
};

/// The matrix that lies in the file `offset` bytes after its start, without a copy. The matrix and its copies own the file:
/// it is unmapped with the last of them. The offset must suit the type, and the file be long enough.
cv::Mat matrix_of(MappedFile file, std::size_t offset, int rows, int columns, int type);

}  // namespace fabloop
