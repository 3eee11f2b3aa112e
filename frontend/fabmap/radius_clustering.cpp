// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <string>
#include <vector>

#include "frontend/error.h"
#include "frontend/fabmap/cluster_means.h"
#include "frontend/fabmap/nearest_rows.h"
#include "frontend/fabmap/sampling.h"
#include "frontend/fabmap/vocabulary_training.h"

namespace fabloop {
namespace {

constexpr std::size_t kBlockSize = 2048;

double squared_distance(const float* a, const float* b, int size) {
  double sum = 0.0;
  for (int i = 0; i < size; ++i) {
    const double difference = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    sum += difference * difference;
  }
  return sum;
}

/// Centres that grow in number, one after another in memory.
struct Centres {
  std::vector<float> numbers;
  int dimensions;

  int count() const { return static_cast<int>(numbers.size()) / dimensions; }
  const float* row(int i) const { return numbers.data() + static_cast<std::ptrdiff_t>(i) * dimensions; }
  cv::Mat copy() const { return cv::Mat(numbers, true).reshape(1, count()); }
};

/// Adds those points of a block that are further than the radius from all centres.
void add_block(Centres& centres, const cv::Mat& block, double squared_radius, int num_threads) {
  const int count_before = centres.count();
  std::vector<float> to_nearest(static_cast<std::size_t>(block.rows), 0.0f);
  if (count_before > 0) to_nearest = nearest_rows(centres.copy(), block, num_threads).squared_distance;
  for (int i = 0; i < block.rows; ++i) {
    const auto* point = block.ptr<float>(i);
    bool is_far = count_before == 0 || static_cast<double>(to_nearest[static_cast<std::size_t>(i)]) > squared_radius;
    for (int centre = count_before; is_far && centre < centres.count(); ++centre) {
      is_far = squared_distance(point, centres.row(centre), block.cols) > squared_radius;
    }
    if (is_far) centres.numbers.insert(centres.numbers.end(), point, point + block.cols);
  }
}

}  // namespace

cv::Mat radius_centres(const cv::Mat& descriptors, const RadiusClusteringOptions& options) {
  if (descriptors.empty()) throw InputError("there are no descriptors to make words of; train on images with more texture");
  if (!(options.radius > 0.0)) throw InputError("radius clustering needs a radius larger than zero; give --radius");
  const cv::Mat points = float_descriptors(descriptors);
  const std::vector<std::size_t> order = random_order(static_cast<std::size_t>(points.rows), options.seed);
  Centres centres{{}, points.cols};
  for (std::size_t begin = 0; begin < order.size(); begin += kBlockSize) {
    const std::size_t end = std::min(begin + kBlockSize, order.size());
    cv::Mat block(static_cast<int>(end - begin), points.cols, CV_32F);
    for (std::size_t i = begin; i < end; ++i) {
      points.row(static_cast<int>(order[i])).copyTo(block.row(static_cast<int>(i - begin)));
    }
    add_block(centres, block, options.radius * options.radius, options.num_threads);
    if (static_cast<std::size_t>(centres.count()) > options.max_words) {
      throw InputError("a radius of " + std::to_string(options.radius) + " gives more than " + std::to_string(options.max_words) +
                       " words; give a larger --radius");
    }
    if (options.progress) options.progress("radius clustering", end, order.size());
  }
  return centres.copy();
}

Vocabulary train_radius_clustering(const cv::Mat& descriptors, const RadiusClusteringOptions& options) {
  const cv::Mat points = float_descriptors(descriptors);
  cv::Mat centres = radius_centres(points, options);
  const NearestRows nearest = nearest_rows(centres, points, options.num_threads);
  move_to_means(centres, points, nearest.row, options.num_threads);
  return {centres};
}

}  // namespace fabloop
