// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace fabloop {

/// The image itself where neither side is longer than `max_side_px`, else a copy shrunk to that, of at least one pixel.
inline cv::Mat within_side(const cv::Mat& image, int max_side_px) {
  const int side_px = std::max(image.cols, image.rows);
  if (side_px <= max_side_px) return image;
  const double scale = static_cast<double>(max_side_px) / side_px;
  const cv::Size size(std::max(1, cvRound(scale * image.cols)), std::max(1, cvRound(scale * image.rows)));
  cv::Mat small;
  cv::resize(image, small, size, 0, 0, cv::INTER_AREA);
  return small;
}

}  // namespace fabloop
