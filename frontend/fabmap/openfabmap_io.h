// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "frontend/fabmap/model.h"
#include "frontend/output_file.h"
#include "frontend/progress.h"

namespace fabloop {

/// openFABMAP's files are matrices in OpenCV's FileStorage: YAML, or whatever else that reads (`.xml`, `.json`), each also
/// compressed (`.gz`). Each file holds one matrix under a name of its own.

/// What is in a file.
enum class OpenFabMapFile {
  Vocabulary,   ///< `Vocabulary`, W x D: the words.
  ChowLiuTree,  ///< `ChowLiuTree`, 4 x W: parent, p, p given parent, p given no parent. A root is its own parent.
  BowImages,    ///< `BOWImageDescs`, N x W: the words of N images; what is not zero was seen.
  Settings,     ///< `openFabMapOptions` and others; see OpenFabMapSettings.
};

/// Which of them a file is. Throws InputError when it cannot be read or is none of them.
OpenFabMapFile openfabmap_file_kind(const std::filesystem::path& path);

/// Throws InputError naming the file when it is missing, no FileStorage file, without a `Vocabulary`, or of a wrong shape,
/// type or number.
Vocabulary read_openfabmap_vocabulary(const std::filesystem::path& path);

/// A tree, or a forest of several roots. Probabilities of 0 and 1 are moved inside by 1e-4 (an event that 10,000 images would
/// not show), and conditionals that are not numbers (of a parent that was always, or never, seen) become the word's own p;
/// `warn` says how many. Throws InputError naming the file and the word for anything else that is no Chow-Liu tree: a parent
/// that does not exist, links in a circle, a p that is not within [0, 1].
ChowLiuTree read_openfabmap_tree(const std::filesystem::path& path, const Warn& warn = {});

/// What training images showed.
struct OpenFabMapImages {
  std::size_t num_words = 0;  ///< Of the vocabulary that they were described with.
  std::vector<Observation> observations;
};

/// The words of each image. Throws InputError as read_openfabmap_vocabulary does.
OpenFabMapImages read_openfabmap_images(const std::filesystem::path& path);

/// The files that make a model.
struct OpenFabMapFiles {
  std::filesystem::path vocabulary;
  std::filesystem::path tree;
  std::filesystem::path images;  ///< Training images for the sampled new place. Empty: none.
};

struct OpenFabMapReadOptions {
  /// How the images were described: the files do not say. openFABMAP describes with OpenCV's defaults, without equalising
  /// contrast and without RootSIFT.
  FeatureOptions features;
  DetectorModel detector;
  std::size_t max_background = 1000;  ///< Images kept for the sampled new place; a seeded choice among more.
  std::uint64_t seed = 1;
  Warn warn;
};

/// A model from them. Throws InputError as the readers do, when the sizes of the files differ, and when the words are not of
/// the length that the features' descriptors have.
Model read_openfabmap_model(const OpenFabMapFiles& files, const OpenFabMapReadOptions& options);

struct OpenFabMapWriteOptions {
  /// Compresses the matrices (`.yml.gz`): a fifth of the size.
  enum class Compression { None, Gzip } compression = Compression::None;
  OutputFolder::IfExists if_exists = OutputFolder::IfExists::Refuse;
};

/// Writes a model as openFABMAP reads it: `vocabulary.yml`, `tree.yml`, `bow.yml` (its background, where it has one) and
/// `settings.yml` (its detector). Words and probabilities come back bit by bit; features, provenance and health are not kept.
/// The folder appears only when it is complete. Throws InputError when the model is invalid or the folder cannot be written.
void write_openfabmap_model(const std::filesystem::path& folder, const Model& model, const OpenFabMapWriteOptions& options = {});

}  // namespace fabloop
