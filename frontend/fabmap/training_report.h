// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "frontend/fabmap/observation.h"
#include "frontend/fabmap/self_test.h"
#include "frontend/fabmap/vocabulary.h"

namespace fabloop {

/// The health of a model: what to look at before trusting it. Made by training and kept in the model file.
struct TrainingReport {
  std::size_t num_images = 0;
  std::size_t num_images_without_words = 0;
  std::size_t num_descriptors = 0;  ///< Those that the words were made of.

  std::size_t num_words = 0;
  std::size_t num_words_never_seen = 0;    ///< In any image: they say nothing.
  std::size_t num_words_always_seen = 0;   ///< In every image: they say nothing either.
  std::size_t num_words_in_one_image = 0;  ///< They cannot link to others, nor recognise anything in training.

  std::size_t min_words_per_image = 0, median_words_per_image = 0, max_words_per_image = 0;
  double mean_words_per_image = 0.0;

  double mutual_information = 0.0;  ///< Held by the tree, nats an image.
  double entropy = 0.0;             ///< Of the words taken alone, nats an image.

  double distance_to_word = 0.0;        ///< Mean Euclidean distance of a descriptor to its word (its quantisation error).
  double distance_between_words = 0.0;  ///< Mean Euclidean distance of a word to the nearest other word.

  SelfTest self_test;
};

/// The figures that images and words give; the rest is left as it is.
TrainingReport count_words(const std::vector<Observation>& observations, std::size_t num_words);

/// How finely descriptors are rounded to words.
struct WordDistances {
  double to_word = 0.0;        ///< TrainingReport::distance_to_word.
  double between_words = 0.0;  ///< TrainingReport::distance_between_words; zero for a single word.
};

/// Measured on at most 10,000 of the N x D `descriptors` (as float_descriptors gives them) and at most 1,000 of the words.
WordDistances measure_distances(const Vocabulary& vocabulary, const cv::Mat& descriptors, int num_threads = 0);

/// What a figure means for the model.
enum class Grade { Good, Fair, Poor };

/// One figure of a report in words.
struct Finding {
  Grade grade = Grade::Good;
  std::string figure;   ///< "words in one image only: 40 of 2000".
  std::string verdict;  ///< "good", or what is wrong and what would help.
};

/// A report in words, figure by figure. The limits between grades are rules of thumb, given with the verdict.
std::vector<Finding> findings(const TrainingReport& report);

/// The report as JSON, as it stands in a model file.
std::string to_json(const TrainingReport& report);

/// The inverse. Throws InputError when something is missing or no number.
TrainingReport training_report_from_json(const std::string& json);

/// The report with its findings as JSON, for people and programs (`fabloop train --report`).
std::string to_json_with_findings(const TrainingReport& report);

}  // namespace fabloop
