// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

#include "frontend/fabmap/model.h"
#include "verification/map/keyframe_map.h"

namespace fabloop {

/// A keyframe map on disk, in one file (SQLite) that grows with the map. Whatever put() has written is there when the program or
/// the machine is killed the next moment, and nothing is ever there by half.
///
/// A later session reads it with read_keyframe_map() and gives it to its LoopCloser; it goes on in the same file with open().
class KeyframeMapFile {
 public:
  /// A new file that holds `map`, which may be empty of keyframes. Throws InputError when it exists already or cannot be written.
  static KeyframeMapFile create(const std::filesystem::path& path, const KeyframeMap& map);

  /// An existing file, to put the session after those that it holds into it. Throws InputError as read_keyframe_map() does.
  static KeyframeMapFile open(const std::filesystem::path& path, const Model& model);

  /// Writes keyframes at the given positions of `map` (LoopEvent::changed): new ones whole, of others their points. Either all of
  /// it is written or nothing. Throws InputError when it cannot be written, or when the file's sessions are not those of the map.
  void put(const KeyframeMap& map, const std::vector<std::size_t>& changed);

  KeyframeMapFile(KeyframeMapFile&&) noexcept;
  KeyframeMapFile& operator=(KeyframeMapFile&&) noexcept;
  ~KeyframeMapFile();

 private:
  struct Implementation;
  explicit KeyframeMapFile(std::unique_ptr<Implementation> implementation);

  std::unique_ptr<Implementation> implementation_;
};

/// The map that a file holds. Throws InputError naming the file when it is missing, something else, of another version, damaged,
/// or was made with another model than `model`.
KeyframeMap read_keyframe_map(const std::filesystem::path& path, const Model& model);

}  // namespace fabloop
