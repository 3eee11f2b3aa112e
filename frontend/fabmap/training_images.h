// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <opencv2/core.hpp>
#include <string_view>
#include <vector>

#include "frontend/fabmap/model_training.h"
#include "frontend/fabmap/observation.h"
#include "frontend/fabmap/vocabulary.h"
#include "frontend/fabmap/word_finder.h"
#include "frontend/work_state.h"

namespace fabloop {

/// What training keeps of one image in the end.
struct ImageWords {
  Observation observation;
  Observation two_thirds;  ///< Of a random two thirds of its descriptors: the self-test's second view of the place.
};

/// Two looks at the images to train on: one for the descriptors that words are made of, one for the words that each shows.
/// Images are looked at in blocks; what was found in a block is kept in the state, so that it is not looked for again.
/// Descriptors are kept from the first look to the second in the state, or in memory where there is none, as far as the
/// options allow; those of the other blocks are asked for twice.
class TrainingImages {
 public:
  /// Keeps references to all.
  TrainingImages(std::size_t num_images, const FeatureSource& features, const ModelTrainingOptions& options,
                 WorkState& state);

  /// N x D, CV_32F: the same share of every image's descriptors, as float_descriptors gives them.
  cv::Mat sample_descriptors();

  /// One an image.
  std::vector<ImageWords> find_words(const Vocabulary& vocabulary);

 private:
  using Block = std::vector<cv::Mat>;  ///< The descriptors of each of its images.

  void for_each_block(std::string_view stage, const std::function<void(std::size_t block)>& body) const;
  std::size_t first_image(std::size_t block) const;
  std::size_t end_image(std::size_t block) const;
  Block describe(std::size_t block) const;
  cv::Mat sample_of(std::size_t block);
  void keep(std::size_t block, Block descriptors);
  Block descriptors_of(std::size_t block);
  std::vector<ImageWords> words_of(std::size_t block, const WordFinder& finder);

  std::size_t num_images_;
  const FeatureSource& features_;
  const ModelTrainingOptions& options_;
  WorkState& state_;
  std::vector<Block> kept_;  ///< In memory; empty where not.
  std::size_t kept_bytes_ = 0;
};

}  // namespace fabloop
