// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "frontend/error.h"
#include "frontend/fabmap/cluster_means.h"
#include "frontend/fabmap/nearest_rows.h"
#include "frontend/fabmap/vocabulary_training.h"
#include "frontend/features/dot_products.h"

namespace fabloop {
namespace {

constexpr int kRowsPerBlock = 2048;

std::uint64_t mixed(std::uint64_t value) {
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;  // SplitMix64 (Steele et al. 2014).
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
  return value ^ (value >> 31);
}

/// The points in an order by chance that depends on their numbers and the seed, not on the order that they came in.
cv::Mat in_own_order(const cv::Mat& points, std::uint64_t seed) {
  std::vector<std::pair<std::uint64_t, int>> order;
  for (int row = 0; row < points.rows; ++row) {
    const auto* numbers = points.ptr<float>(row);
    std::uint64_t key = mixed(seed + 1);
    for (int i = 0; i < points.cols; ++i) key = mixed(key + std::bit_cast<std::uint32_t>(numbers[i]) + 1);
    order.emplace_back(key, row);
  }
  // Equal keys are equal points, but for one pair in 2^64.
  std::sort(order.begin(), order.end());
  cv::Mat result(points.size(), CV_32F);
  for (int i = 0; i < points.rows; ++i) points.row(order[static_cast<std::size_t>(i)].second).copyTo(result.row(i));
  return result;
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
      is_far = static_cast<double>(squared_distance(point, centres.row(centre), static_cast<std::size_t>(block.cols))) >
               squared_radius;
    }
    if (is_far) centres.numbers.insert(centres.numbers.end(), point, point + block.cols);
  }
}

/// The centres of points that are in their own order.
cv::Mat centres_of(const cv::Mat& points, const RadiusClusteringOptions& options) {
  Centres centres{{}, points.cols};
  for (int begin = 0; begin < points.rows; begin += kRowsPerBlock) {
    const int end = std::min(begin + kRowsPerBlock, points.rows);
    add_block(centres, points.rowRange(begin, end), options.radius * options.radius, options.num_threads);
    if (static_cast<std::size_t>(centres.count()) > options.max_words) {
      throw InputError("a radius of " + std::to_string(options.radius) + " gives more than " + std::to_string(options.max_words) +
                       " words; give a larger --radius");
    }
    if (options.progress) {
      options.progress("radius clustering", static_cast<std::size_t>(end), static_cast<std::size_t>(points.rows));
    }
  }
  return centres.copy();
}

cv::Mat valid_points(const cv::Mat& descriptors, const RadiusClusteringOptions& options) {
  if (descriptors.empty()) throw InputError("there are no descriptors to make words of; train on images with more texture");
  if (!(options.radius > 0.0)) throw InputError("radius clustering needs a radius larger than zero; give --radius");
  return in_own_order(float_descriptors(descriptors), options.seed);
}

}  // namespace

cv::Mat radius_centres(const cv::Mat& descriptors, const RadiusClusteringOptions& options) {
  return centres_of(valid_points(descriptors, options), options);
}

Vocabulary train_radius_clustering(const cv::Mat& descriptors, const RadiusClusteringOptions& options) {
  const cv::Mat points = valid_points(descriptors, options);
  cv::Mat centres = centres_of(points, options);
  const NearestRows nearest = nearest_rows(centres, points, options.num_threads);
  move_to_means(centres, points, nearest.row, options.num_threads);
  return {centres};
}

}  // namespace fabloop
