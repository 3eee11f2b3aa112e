// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "frontend/fabmap/chow_liu_tree.h"
#include "frontend/fabmap/detector_model.h"
#include "frontend/fabmap/domain.h"
#include "frontend/fabmap/observation.h"
#include "frontend/fabmap/training_report.h"
#include "frontend/fabmap/vocabulary.h"
#include "frontend/features/feature_extractor.h"

namespace fabloop {

/// Where a model came from. No date, so that the same training gives the same file.
struct Provenance {
  std::string fabloop_version;
  std::string command;  ///< The options that made it.
  std::uint64_t seed = 0;
  std::uint64_t num_images = 0;
  std::uint64_t num_descriptors = 0;  ///< Those that the words were made of.
};

/// Everything that place recognition must know before its first image.
struct Model {
  FeatureOptions features;  ///< How images must be looked at for the words to mean something.
  Vocabulary vocabulary;
  ChowLiuTree tree;  ///< One node for each word.
  DetectorModel detector;
  std::vector<Observation> background;  ///< Views of elsewhere, for the sampled new place.
  Provenance provenance;
  std::optional<TrainingReport> health;  ///< Of models that training made here.
  std::optional<Domain> domain;          ///< What the training images look like; see DomainCheck.
};

/// Throws InputError naming `where` when a part is invalid or the parts do not fit together.
void validate(const Model& model, const std::string& where);

/// The same model with its words taken as independent: the tree without its links, and without `domain`, which was measured with
/// them.
Model naive_bayes(Model model);

/// Throws InputError that says which option differs, when images described with `features` would not have the model's words.
void require_features(const Model& model, const FeatureOptions& features);

/// Whether a file says of itself that it is a model file. False when it cannot be read.
bool is_model_file(const std::filesystem::path& path);

/// Reads a model file and validates all of it. The words stay in the file, which is mapped: `vocabulary.words` and its copies
/// keep the mapping alive, and writing to them does not change the file (see MappedFile). Throws InputError naming the file when
/// it is missing, truncated, of another kind or version, or holds anything invalid.
Model read_model(const std::filesystem::path& path);

/// Writes a model file. The same model gives the same bytes. The file appears only when it is complete. Throws InputError
/// when the model is invalid or the file cannot be written.
void write_model(const std::filesystem::path& path, const Model& model);

}  // namespace fabloop
