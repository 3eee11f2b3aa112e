// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/lab/lab_description.h"
#include "apps/lab/lab_settings.h"

namespace fabloop {

/// One run of an experiment: one combination of data, seed and swept values.
struct LabCell {
  std::string data;  ///< "synthetic", or the name of the sequence's folder; "A after B" with an earlier flight.
  std::uint64_t seed = 1;
  std::vector<std::pair<std::string, double>> swept;  ///< In the order of the description.
  LabSettings settings;                               ///< With the swept values, and the seed in its trouble.
  std::filesystem::path folder;                       ///< Of the sequence; empty for synthetic data.
  std::filesystem::path earlier_folder;               ///< See SequenceData::earlier; empty: none.
  double height_above_ground_m = 60.0;

  /// "synthetic, aliasing 0.3": what cells of different seeds have in common.
  std::string group() const;
};

/// The cells of a description, sequences and swept values outermost, seeds innermost. `data_root` is what the folders of
/// sequences are relative to. Throws InputError when two sequences have one name.
std::vector<LabCell> cells_of(const LabDescription& description, const std::filesystem::path& data_root);

/// Everything that a cell's result depends on, in one text: version of the program and of its results
/// (kResultVersion), settings, data, methods with the contents of files of scores, how far pairs are judged, back ends. Of
/// sequences it has the files' names, the checksums of texts, and the sizes and times of change of images. A program that was
/// built anew under the same versions gives the same text. Throws InputError when a folder or a file of scores cannot be read.
std::string cell_text(const LabCell& cell, const LabDescription& description);

/// Checksum of that text, 16 hexadecimal digits: the name of the cell's file.
std::string cell_checksum(const LabCell& cell, const LabDescription& description);

/// The file of scores of a method for a cell, its placeholders replaced; a parameter's value has as few digits as it takes (0.3).
/// Empty for built-in methods.
std::filesystem::path scores_file(const LabMethod& method, const LabCell& cell, const LabDescription& description);

/// Folder names of sequences may end in a slash.
std::string name_of_folder(const std::filesystem::path& folder);

}  // namespace fabloop
