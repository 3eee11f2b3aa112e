// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "frontend/fabmap/chow_liu_training.h"
#include "frontend/fabmap/detector_model.h"
#include "frontend/fabmap/model.h"
#include "frontend/fabmap/training_report.h"
#include "frontend/features/feature_extractor.h"
#include "frontend/progress.h"
#include "frontend/sequence/sequence.h"
#include "frontend/work_state.h"

namespace fabloop {

/// How words are made of descriptors.
enum class VocabularyMethod {
  KMeans,  ///< To a wanted number of words; see train_k_means.
  Radius,  ///< To a wanted resolution; see train_radius_clustering.
};

struct ModelTrainingOptions {
  FeatureOptions features;  ///< How the images are described. Kept in the model.
  VocabularyMethod method = VocabularyMethod::KMeans;
  /// Only for k-means. None: default_num_words. More tell places apart better and want more training images.
  std::optional<std::size_t> num_words;
  double radius = 0.0;  ///< Only for radius clustering; see RadiusClusteringOptions.
  /// At most about so many descriptors make the words, the same share of every image. Bounds time and memory.
  std::size_t max_descriptors = 250000;
  /// Descriptors of as many images as fit are kept in memory from the first look at the images to the second; the others are
  /// asked for twice. Bounds memory. Only where there is no state folder.
  std::size_t max_kept_bytes = std::size_t{1} << 30;
  std::size_t max_background = 1000;  ///< Observations kept for the sampled new place.
  DetectorModel detector;             ///< Raise p_seen_if_present for detectors that repeat better.
  ChowLiuOptions tree;                ///< Its progress is replaced by the one below.
  std::uint64_t seed = 1;
  int num_threads = 0;  ///< 0: all. The model does not depend on it.
  std::string command;  ///< Kept in the model's provenance: the options that a user gave.
  /// Folder to keep work in that is done, so that the same training, killed at any moment, goes on there when it is called
  /// again: see WorkState. It stays until its owner removes it. Empty: nothing is kept.
  std::filesystem::path state_folder;
  WorkState::IfFound if_state_found = WorkState::IfFound::Resume;
  /// The state folder keeps so many bytes of descriptors; images beyond are described twice. Bounds the disk.
  std::size_t max_state_bytes = std::size_t{8} << 30;
  /// Names the images, so that the state of other images is not taken for theirs. train_model on sequences adds the names,
  /// sizes and times of the files by itself.
  std::string images_identity;
  Warn warn;  ///< Told where a training resumes, and about a state that does not fit or is damaged.
  Progress progress;
};

struct TrainedModel {
  Model model;
  TrainingReport report;  ///< Also in the model.
};

/// The features of image i of those to train on. Called from several threads, and more than once for the same image.
using FeatureSource = std::function<Features(std::size_t image)>;

/// Everything that the descriptors of an image depend on besides the image, one thing a line: for WorkState's inputs.
std::string features_text(const FeatureOptions& features);

/// One word for 20 descriptors, at least 1 and at most 10,000: an image of 1,500 features then shows a tenth to a fifth of them.
std::size_t default_num_words(std::size_t num_descriptors);

/// A model from `num_images` images: words from their descriptors, the tree from the words that each shows, and a sample of
/// the images as the background. The same images and options give the same model. Throws InputError when there are no
/// images, no descriptors, or an option is invalid.
TrainedModel train_model(std::size_t num_images, const FeatureSource& features, const ModelTrainingOptions& options = {});

/// The same from all images of the sequences. Throws InputError also for an image that cannot be read.
TrainedModel train_model(const std::vector<Sequence>& sequences, const ModelTrainingOptions& options = {});

}  // namespace fabloop
