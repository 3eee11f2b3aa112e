// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/training_report.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frontend/fabmap/nearest_rows.h"
#include "frontend/fabmap/sampling.h"
#include "frontend/features/descriptor_distances.h"

namespace fabloop {
namespace {

cv::Mat sampled(const cv::Mat& rows, std::size_t wanted, std::uint64_t seed) {
  cv::Mat result;
  for (const std::size_t row : sample_without_replacement(static_cast<std::size_t>(rows.rows), wanted, seed)) {
    result.push_back(rows.row(static_cast<int>(row)));
  }
  return result;
}

double mean_root(const std::vector<float>& squared) {
  double sum = 0.0;
  for (const float value : squared) sum += std::sqrt(static_cast<double>(std::max(0.0f, value)));
  return squared.empty() ? 0.0 : sum / static_cast<double>(squared.size());
}

/// Of each of `some` words, which are among all `words`, the squared distance to the nearest of the others.
std::vector<float> to_nearest_other(const cv::Mat& words, const std::vector<std::size_t>& some) {
  const PackedDescriptors packed(words);
  std::vector<float> nearest;
  for (const std::size_t word : some) {
    cv::Mat1f distances = packed.squared_distances(words.row(static_cast<int>(word)));
    distances(0, static_cast<int>(word)) = std::numeric_limits<float>::max();
    nearest.push_back(*std::min_element(distances.begin(), distances.end()));
  }
  return nearest;
}

}  // namespace

TrainingReport count_words(const std::vector<Observation>& observations, std::size_t num_words) {
  TrainingReport report;
  report.num_images = observations.size();
  report.num_words = num_words;
  std::vector<std::size_t> images(num_words, 0), counts;
  for (const Observation& observation : observations) {
    counts.push_back(observation.words.size());
    for (const WordId word : observation.words) ++images[word];
  }
  if (counts.empty()) return report;
  std::sort(counts.begin(), counts.end());
  const auto count_of = [](const std::vector<std::size_t>& values, std::size_t value) {
    return static_cast<std::size_t>(std::count(values.begin(), values.end(), value));
  };
  report.num_images_without_words = count_of(counts, 0);
  report.min_words_per_image = counts.front();
  report.median_words_per_image = counts[counts.size() / 2];
  report.max_words_per_image = counts.back();
  for (const std::size_t count : counts) report.mean_words_per_image += static_cast<double>(count);
  report.mean_words_per_image /= static_cast<double>(counts.size());
  report.num_words_never_seen = count_of(images, 0);
  report.num_words_always_seen = count_of(images, observations.size());
  report.num_words_in_one_image = count_of(images, 1);
  return report;
}

WordDistances measure_distances(const Vocabulary& vocabulary, const cv::Mat& descriptors, int num_threads) {
  constexpr std::size_t kMaxDescriptors = 10000;
  constexpr std::size_t kMaxWords = 1000;
  constexpr std::uint64_t kSeed = 1;
  WordDistances distances;
  const cv::Mat points = sampled(descriptors, kMaxDescriptors, kSeed);
  if (!points.empty()) distances.to_word = mean_root(nearest_rows(vocabulary.words, points, num_threads).squared_distance);
  if (vocabulary.num_words() > 1) {
    const auto some = sample_without_replacement(vocabulary.num_words(), kMaxWords, kSeed);
    distances.between_words = mean_root(to_nearest_other(vocabulary.words, some));
  }
  return distances;
}

}  // namespace fabloop
