// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/baselines/sequence_matching.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "frontend/error.h"

namespace fabloop {
namespace {

constexpr double kNothing = -std::numeric_limits<double>::infinity();

void check(const SequenceMatchingOptions& options) {
  if (options.length == 0 || !(options.min_speed > 0.0) || !(options.max_speed >= options.min_speed) ||
      !(options.speed_step > 0.0)) {
    throw InputError("sequence matching: the length must be 1 or more, and the speeds positive and ascending");
  }
}

/// Eq. 2, with running sums. A row whose differences are all alike around a place says nothing of it: 0.
std::vector<double> contrast_enhanced(const std::vector<float>& row, std::size_t window) {
  const std::size_t half = window / 2;
  std::vector<double> sums(row.size() + 1, 0.0), squares(row.size() + 1, 0.0);
  for (std::size_t j = 0; j < row.size(); ++j) {
    const double difference = row[j];
    sums[j + 1] = sums[j] + difference;
    squares[j + 1] = squares[j] + difference * difference;
  }
  std::vector<double> result(row.size(), 0.0);
  constexpr double kLeastVariance = 1e-12;
  for (std::size_t j = 0; j < row.size(); ++j) {
    const std::size_t begin = j - std::min(j, half), end = std::min(row.size(), j + half + 1);
    const auto count = static_cast<double>(end - begin);
    const double mean = (sums[end] - sums[begin]) / count;
    const double variance = (squares[end] - squares[begin]) / count - mean * mean;
    if (variance > kLeastVariance) result[j] = (static_cast<double>(row[j]) - mean) / std::sqrt(variance);
  }
  return result;
}

/// Mean along the line that ends at (query, place); none where it leaves the rows.
std::optional<double> mean_along(const std::vector<std::vector<double>>& rows, std::size_t query, std::size_t place, double speed,
                                 std::size_t length) {
  double sum = 0.0;
  for (std::size_t k = 0; k < length; ++k) {
    const auto back = static_cast<std::size_t>(std::llround(speed * static_cast<double>(k)));
    if (back > place || place - back >= rows[query - k].size()) return std::nullopt;
    sum += rows[query - k][place - back];
  }
  return sum / static_cast<double>(length);
}

}  // namespace

cv::Mat1f small_image(const cv::Mat& gray, const SequenceMatchingOptions& options) {
  const int side = options.patch_px;
  if (side < 1 || options.width_px < side || options.height_px < side || options.width_px % side != 0 ||
      options.height_px % side != 0) {
    throw InputError("sequence matching: the small image's sides must be multiples of the patch's");
  }
  cv::Mat resized;
  cv::resize(gray, resized, {options.width_px, options.height_px}, 0, 0, cv::INTER_AREA);
  cv::Mat1f result;
  resized.convertTo(result, CV_32F);
  for (int y = 0; y < result.rows; y += side) {
    for (int x = 0; x < result.cols; x += side) {
      cv::Mat1f patch = result(cv::Rect(x, y, side, side));
      cv::Scalar mean, deviation;
      cv::meanStdDev(patch, mean, deviation);
      patch -= mean[0];
      if (deviation[0] > 0.0) patch *= 1.0 / deviation[0];
    }
  }
  return result;
}

std::vector<std::vector<double>> sequence_scores(const DifferenceRows& differences, const SequenceMatchingOptions& options) {
  check(options);
  std::vector<std::vector<double>> enhanced;
  for (const std::vector<float>& row : differences) enhanced.push_back(contrast_enhanced(row, options.contrast_window));
  const auto num_speeds =
      static_cast<std::size_t>(std::floor((options.max_speed - options.min_speed) / options.speed_step + 1e-9)) + 1;
  std::vector<std::vector<double>> scores;
  for (std::size_t query = 0; query < enhanced.size(); ++query) {
    std::vector<double> row(enhanced[query].size(), kNothing);
    for (std::size_t place = 0; query + 1 >= options.length && place < row.size(); ++place) {
      for (std::size_t s = 0; s < num_speeds; ++s) {
        const double speed = options.min_speed + static_cast<double>(s) * options.speed_step;
        if (const auto mean = mean_along(enhanced, query, place, speed, options.length))
          row[place] = std::max(row[place], -*mean);
      }
    }
    scores.push_back(std::move(row));
  }
  return scores;
}

}  // namespace fabloop
