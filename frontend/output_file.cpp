// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/output_file.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "frontend/error.h"
#include "frontend/work_state.h"

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

void OutputFolder::require_usable(const fs::path& given, IfExists if_exists) {
  const fs::path path = without_trailing_slash(given);
  std::error_code error;
  if (!fs::exists(path, error)) return;
  const std::string name = path.string();
  if (!fs::is_directory(path, error)) throw InputError(name + ": is a file, not a folder; choose another --out");
  if (if_exists == IfExists::Refuse && !fs::is_empty(path, error)) {
    throw InputError(name + ": exists already; choose another --out, or give --overwrite to replace it");
  }
}

fs::path OutputFolder::part_path_of(const fs::path& path) { return with_suffix(without_trailing_slash(path), ".part"); }

OutputFolder::OutputFolder(fs::path path, IfExists if_exists, fs::path part_path)
    : path_(without_trailing_slash(path)), part_path_(part_path.empty() ? part_path_of(path_) : std::move(part_path)) {
  require_usable(path_, if_exists);
  std::error_code error;
  if (fs::exists(part_path_ / WorkState::kInputsName, error)) {
    throw InputError(part_path_.string() +
                     ": holds the work of a run that was stopped; finish that run, remove the folder, or choose another --out");
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
