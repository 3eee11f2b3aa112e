// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "frontend/fabmap/state_bytes.h"
#include "frontend/progress.h"

namespace fabloop {

/// The folder in which a long training keeps what it has done, so that the same training, killed at any moment, goes on from
/// there. Every file is named, appears only when it is complete, and carries a checksum: a damaged one counts as missing.
///
/// The folder belongs to its `inputs`: a text that names everything the result depends on. With other inputs it starts empty.
/// Keeping work is a convenience: when a file cannot be written (a full disk), the training is told, the folder is removed so
/// that the model finds room, and the training goes on without.
class TrainingState {
 public:
  /// What to do with work that a former run left.
  enum class IfFound { Resume, Discard };

  /// Keeps nothing.
  TrainingState() = default;

  /// Throws InputError when the folder is something else than a training state, or cannot be created.
  TrainingState(std::filesystem::path folder, const std::string& inputs, IfFound if_found, Warn warn);

  bool keeps() const { return !folder_.empty(); }

  /// Whether a former run with the same inputs left this file. It may still be damaged.
  bool has(const std::string& name) const;

  /// What was written under that name; none when there is nothing, or when it is damaged (the training is told).
  std::optional<StateBytes> read(const std::string& name) const;

  void write(const std::string& name, const StateBytes& bytes);

  /// Frees the disk of what is not needed any more.
  void remove(const std::string& name);

  /// Removes the folder; nothing is kept from now on.
  void discard();

  /// Tells that `name` was readable but made no sense.
  void warn_damaged(const std::string& name) const;

  const std::filesystem::path& folder() const { return folder_; }

 private:
  void open(const std::string& inputs, IfFound if_found);
  void give_up(const std::string& why);

  std::filesystem::path folder_;  ///< Empty: keeps nothing.
  Warn warn_;
};

}  // namespace fabloop
