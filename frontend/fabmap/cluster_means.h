// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace fabloop {

/// Moves each of `centres` (W x D, CV_32F) to the mean of the points (N x D) assigned to it; `assignment` names a centre for
/// each point. A centre without points stays. Returns the number of points of each centre. Sums in the order of the points,
/// whatever the number of threads (0: all).
std::vector<std::size_t> move_to_means(cv::Mat& centres, const cv::Mat& points, const std::vector<std::uint32_t>& assignment,
                                       int num_threads);

}  // namespace fabloop
