// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/output_file.h"

#include <cerrno>
#include <cstring>
#include <system_error>

#include "frontend/error.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

fs::path with_suffix(const fs::path& path, const char* suffix) {
  fs::path result = path;
  result += suffix;
  return result;
}

/// "runs/a/" and "runs/a" are the same folder, but only the latter can be renamed to.
fs::path without_trailing_slash(const fs::path& path) { return path.has_filename() ? path : path.parent_path(); }

}  // namespace

OutputFile::OutputFile(fs::path path) : path_(std::move(path)), part_path_(with_suffix(path_, ".part")) {
  errno = 0;
  stream_.open(part_path_, std::ios::binary | std::ios::trunc);
  if (!stream_) throw InputError(path_.string() + ": cannot be written (" + std::strerror(errno) + "); choose another place");
}

OutputFile::~OutputFile() {
  if (committed_) return;
  stream_.close();
  std::error_code ignored;
  fs::remove(part_path_, ignored);
}

void OutputFile::commit() {
  errno = 0;
  stream_.flush();
  stream_.close();
  if (!stream_) {
    throw InputError(path_.string() + ": could not be written completely (" + std::strerror(errno) +
                     "); nothing was kept: free some space and run again");
  }
  std::error_code error;
  fs::rename(part_path_, path_, error);
  if (error) throw InputError(path_.string() + ": cannot be written (" + error.message() + "); choose another place");
  committed_ = true;
}

OutputFolder::OutputFolder(fs::path path, IfExists if_exists)
    : path_(without_trailing_slash(path)), part_path_(with_suffix(path_, ".part")) {
  std::error_code error;
  if (fs::exists(path_, error)) {
    if (!fs::is_directory(path_, error)) throw InputError(path_.string() + ": is a file, not a folder; choose another --out");
    if (if_exists == IfExists::Refuse && !fs::is_empty(path_, error)) {
      throw InputError(path_.string() + ": exists already; choose another --out, or give --overwrite to replace it");
    }
  }
  fs::remove_all(part_path_, error);
  fs::create_directories(part_path_, error);
  if (error) throw InputError(path_.string() + ": cannot be created (" + error.message() + "); choose another place");
}

OutputFolder::~OutputFolder() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove_all(part_path_, ignored);
}

void OutputFolder::commit() {
  const fs::path old_path = with_suffix(path_, ".old");
  std::error_code error;
  const bool had_old = fs::exists(path_, error);
  if (had_old) {
    fs::remove_all(old_path, error);
    fs::rename(path_, old_path, error);
    if (error) throw InputError(path_.string() + ": cannot be replaced (" + error.message() + "); choose another --out");
  }
  fs::rename(part_path_, path_, error);
  if (error) throw InputError(path_.string() + ": cannot be written (" + error.message() + "); choose another place");
  committed_ = true;
  if (had_old) fs::remove_all(old_path, error);
}

}  // namespace fabloop
