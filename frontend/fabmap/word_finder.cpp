// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/word_finder.h"

namespace fabloop {
namespace {

const cv::Mat& valid_words(const Vocabulary& vocabulary) {
  validate(vocabulary, "vocabulary");
  return vocabulary.words;
}

}  // namespace

WordFinder::WordFinder(const Vocabulary& vocabulary, const WordFinderOptions& options)
    : vocabulary_(vocabulary), options_(options), search_(valid_words(vocabulary), RowSearchKind::ManyTimes) {}

std::vector<WordId> WordFinder::nearest_words(const cv::Mat& descriptors) const {
  const cv::Mat points = float_descriptors_for(vocabulary_, descriptors);
  if (points.empty()) return {};
  return (options_.search == WordSearch::Exact ? search_.nearest(points, 1) : search_.near(points, 1)).row;
}

Observation WordFinder::observe(const cv::Mat& descriptors) const { return observation_of(nearest_words(descriptors)); }

}  // namespace fabloop
