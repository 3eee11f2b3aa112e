// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "frontend/fabmap/observation.h"

namespace fabloop {

/// Visual words: the typical descriptors to which all others are rounded.
struct Vocabulary {
  cv::Mat words;  ///< W x D, CV_32F, continuous. For packed bits of B bytes, D = 8 B.

  std::size_t num_words() const { return static_cast<std::size_t>(words.rows); }
};

/// Descriptors as vocabularies take them: N x D, CV_32F, continuous. Floats stay as they are; packed bits (CV_8U, B bytes)
/// become 8 B numbers 0 or 1, lowest bit of each byte first, so that squared Euclidean distance is Hamming distance. Throws
/// InputError when a descriptor has entries that are not finite, or when the type is another.
cv::Mat float_descriptors(const cv::Mat& descriptors);

/// The same for descriptors that are to be rounded to words: throws InputError also when they are of another length.
cv::Mat float_descriptors_for(const Vocabulary& vocabulary, const cv::Mat& descriptors);

/// The word nearest to each of N descriptors (exact, squared Euclidean distance). Descriptors are as an extractor gives them.
/// Of words equally near, the lower. Throws InputError as float_descriptors does, and when the descriptors are of another length
/// than the words. For many images a WordFinder is several times faster.
std::vector<WordId> nearest_words(const Vocabulary& vocabulary, const cv::Mat& descriptors);

/// FAB-MAP's Z of an image with these words: sorted, without repeats.
Observation observation_of(std::vector<WordId> words);

/// FAB-MAP's Z: the words that N descriptors are rounded to. None for no descriptors. Throws as nearest_words does.
/// For many images a WordFinder is several times faster.
Observation observe(const Vocabulary& vocabulary, const cv::Mat& descriptors);

/// Throws InputError naming `where` unless there is a word and all its numbers are finite.
void validate(const Vocabulary& vocabulary, const std::string& where);

}  // namespace fabloop
