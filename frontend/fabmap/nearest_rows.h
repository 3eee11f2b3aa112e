// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace fabloop {

/// For each of N points, which row is nearest and how far it is.
struct NearestRows {
  std::vector<std::uint32_t> row;       ///< N.
  std::vector<float> squared_distance;  ///< N, squared Euclidean.
};

/// The row of `rows` (W x D, CV_32F, continuous, W >= 1) nearest to each of `points` (N x D, likewise), by exhaustive search
/// on up to `num_threads` threads (0: all). Points are searched in blocks of fixed size, so that the result does not depend
/// on the number of threads.
NearestRows nearest_rows(const cv::Mat& rows, const cv::Mat& points, int num_threads);

}  // namespace fabloop
