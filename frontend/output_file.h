// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <ostream>

namespace fabloop {

/// A file that appears under its final name only when it is complete: it is written beside it as `NAME.part`, and renamed
/// by commit(). Without commit() (an exception, say) the part is removed.
class OutputFile {
 public:
  /// Throws InputError when the file cannot be created there.
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ostream& stream() { return stream_; }

  /// Flushes, syncs and renames. Throws InputError when anything could not be written (a full disk, say).
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path part_path_;
  std::ofstream stream_;
  bool committed_ = false;
};

/// A folder that appears under its final name only when it is complete: files are written into `NAME.part` (or another folder on
/// the same disk), and commit() renames it. Without commit() the part is removed.
class OutputFolder {
 public:
  /// What to do when the folder exists already and is not empty.
  enum class IfExists { Refuse, Replace };

  /// Throws InputError when the folder exists (unless `Replace`) or cannot be created. With `Replace` the old folder stays
  /// until commit(). An empty `part_path` is `NAME.part`. Kept work (WorkState) that lies there is not removed:
  /// InputError.
  explicit OutputFolder(std::filesystem::path path, IfExists if_exists = IfExists::Refuse, std::filesystem::path part_path = {});
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Throws InputError when the constructor would, because of what exists under that name; changes nothing. For long work, whose
  /// user wants to know before it and not after it.
  static void require_usable(const std::filesystem::path& path, IfExists if_exists);

  /// `NAME.part` of a folder, whether or not NAME ends in a slash.
  static std::filesystem::path part_path_of(const std::filesystem::path& path);

  /// Where to write the files.
  const std::filesystem::path& part_path() const { return part_path_; }

  /// Renames the part to its final name. Throws InputError when that fails.
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path part_path_;
  bool committed_ = false;
};

}  // namespace fabloop
