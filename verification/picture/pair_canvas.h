// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace fabloop {

inline constexpr int kPairGapPx = 10;  ///< Between the images.

/// Both images side by side, dimmed, and where their pixels lie in the picture.
struct PairCanvas {
  cv::Mat picture;
  double query_scale = 1, match_scale = 1;
  cv::Rect query_place, match_place;

  static cv::Point2d at(const cv::Rect& place, double scale, const cv::Point2f& pixel) {
    return {place.x + (static_cast<double>(pixel.x) + 0.5) * scale - 0.5,
            place.y + (static_cast<double>(pixel.y) + 0.5) * scale - 0.5};
  }
  cv::Point2d in_query(const cv::Point2f& pixel) const { return at(query_place, query_scale, pixel); }
  cv::Point2d in_match(const cv::Point2f& pixel) const { return at(match_place, match_scale, pixel); }
};

/// The images, of any size, scaled to one width.
PairCanvas make_pair_canvas(const cv::Mat& query_gray, const cv::Mat& match_gray, int image_width_px);

}  // namespace fabloop
