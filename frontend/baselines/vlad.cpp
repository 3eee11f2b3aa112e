// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/baselines/vlad.h"

#include "frontend/fabmap/vocabulary_training.h"

namespace fabloop {

Vocabulary vlad_centres(const Vocabulary& vocabulary, const VladOptions& options) {
  KMeansOptions clustering;
  clustering.num_words = options.num_centres;
  clustering.seed = options.seed;
  clustering.num_threads = 1;
  return train_k_means(vocabulary.words, clustering);
}

cv::Mat vlad_of(const Vocabulary& centres, const cv::Mat& descriptors) {
  const int length = centres.words.cols;
  cv::Mat sums = cv::Mat::zeros(centres.words.rows, length, CV_32F);
  const cv::Mat points = float_descriptors_for(centres, descriptors);
  const std::vector<WordId> nearest = nearest_words(centres, descriptors);
  for (int i = 0; i < points.rows; ++i) {
    const auto centre = static_cast<int>(nearest[static_cast<std::size_t>(i)]);
    sums.row(centre) += points.row(i) - centres.words.row(centre);
  }
  for (int k = 0; k < sums.rows; ++k) {
    const double norm = cv::norm(sums.row(k));
    if (norm > 0.0) sums.row(k) *= 1.0 / norm;
  }
  const double norm = cv::norm(sums);
  if (norm > 0.0) sums *= 1.0 / norm;
  return sums.reshape(1, 1);
}

double vlad_score(const cv::Mat& a, const cv::Mat& b) { return a.dot(b); }

}  // namespace fabloop
