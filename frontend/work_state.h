// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "frontend/progress.h"
#include "frontend/state_bytes.h"

namespace fabloop {

/// The folder in which long work (a training, a map) keeps what it has done, so that the same work, killed at any moment, goes on
/// from there. Every file is named, appears only when it is complete, and carries a checksum: a damaged one counts as missing.
///
/// The folder belongs to its `inputs`: a text that names everything the kept work depends on. With other inputs it starts empty.
/// Keeping work is a convenience: when a file cannot be written (a full disk), the user is told, the folder is removed so that
/// the result finds room, and the work goes on without.
class WorkState {
 public:
  /// The file of its inputs: a folder that has it is a state.
  static constexpr const char* kInputsName = "inputs.txt";

  /// What to do with work that a former run left.
  enum class IfFound { Resume, Discard };

  /// Keeps nothing.
  WorkState() = default;

  /// `work` is what messages call it ("training"). Throws InputError when the folder holds something else than such a state, or
  /// cannot be created.
  WorkState(std::filesystem::path folder, std::string work, const std::string& inputs, IfFound if_found, Warn warn);

  bool keeps() const { return !folder_.empty(); }

  /// Whether a former run with the same inputs left this file. It may still be damaged.
  bool has(const std::string& name) const;

  /// What was written under that name; none when there is nothing, or when it is damaged (the user is told).
  std::optional<StateBytes> read(const std::string& name) const;

  /// What `take` makes of the bytes under that name: all of them, or it is damaged.
  template <typename Take>
  auto read_as(const std::string& name, const Take& take) const -> std::optional<decltype(take(std::declval<StateBytes&>()))> {
    std::optional<StateBytes> bytes = read(name);
    if (!bytes) return std::nullopt;
    try {
      auto thing = take(*bytes);
      if (bytes->at_end()) return thing;
    } catch (const StateDamaged&) {
    }
    warn_damaged(name);
    return std::nullopt;
  }

  void write(const std::string& name, const StateBytes& bytes);

  /// Frees the disk of what is not needed any more.
  void remove(const std::string& name);

  /// Removes all files but those numbered under `what`.
  void remove_all_but(const std::string& what);

  /// Removes the folder; nothing is kept from now on.
  void discard();

  /// Tells that `name` was readable but made no sense.
  void warn_damaged(const std::string& name) const;

  const std::filesystem::path& folder() const { return folder_; }

 private:
  void open(const std::string& inputs, IfFound if_found);
  void give_up(const std::string& why);

  std::filesystem::path folder_;  ///< Empty: keeps nothing.
  std::string work_;
  Warn warn_;
};

/// "pairs-00012": the name of one of many files.
std::string numbered_name(const std::string& what, std::size_t number);

/// Name, size and time of a file as a line of a state's inputs; not its folder, which may be moved.
std::string file_identity(const std::filesystem::path& path);

}  // namespace fabloop
