// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace fabloop {

/// Keeps a folder for one program at a time, for as long as it lives. The system gives the folder free when the program ends,
/// however it ends, and nothing is written into it. On file systems that know no locks it keeps nobody out.
class FolderLock {
 public:
  /// Throws InputError when another program (or another FolderLock of this one) has the folder, or when there is no such folder.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace fabloop
