// SPDX-License-Identifier: BSD-3-Clause
#include "verification/picture/pair_canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "frontend/recognition/plot.h"

namespace fabloop {
namespace {

/// The grey level that a share of the pixels do not exceed.
int grey_quantile(const cv::Mat& gray, double share) {
  std::array<std::size_t, 256> counts{};
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) ++counts[gray.at<std::uint8_t>(y, x)];
  }
  const double wanted = share * static_cast<double>(gray.total());
  std::size_t sum = 0;
  int level = 0;
  while (level < 255 && static_cast<double>(sum += counts[static_cast<std::size_t>(level)]) < wanted) ++level;
  return level;
}

/// Scaled, the grey levels stretched, since dark images hide what matched, and dimmed for colours to stand out.
cv::Mat backdrop(const cv::Mat& gray, const cv::Size& size) {
  constexpr double kBrightest = 190, kDarkest = 15, kOutliers = 0.01;
  cv::Mat scaled, colour;
  cv::resize(gray, scaled, size, 0, 0, size.width < gray.cols ? cv::INTER_AREA : cv::INTER_CUBIC);
  const int low = grey_quantile(scaled, kOutliers), high = grey_quantile(scaled, 1.0 - kOutliers);
  const double gain = (kBrightest - kDarkest) / std::max(1, high - low);
  scaled.convertTo(scaled, CV_8U, gain, kDarkest - gain * low);
  cv::min(scaled, kBrightest, scaled);
  cv::cvtColor(scaled, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

}  // namespace

PairCanvas make_pair_canvas(const cv::Mat& query_gray, const cv::Mat& match_gray, int image_width_px) {
  PairCanvas canvas;
  canvas.query_scale = static_cast<double>(image_width_px) / query_gray.cols;
  canvas.match_scale = static_cast<double>(image_width_px) / match_gray.cols;
  const auto height_of = [](const cv::Mat& gray, double scale) { return std::max(1, cvRound(scale * gray.rows)); };
  canvas.query_place = {0, 0, image_width_px, height_of(query_gray, canvas.query_scale)};
  canvas.match_place = {image_width_px + kPairGapPx, 0, image_width_px, height_of(match_gray, canvas.match_scale)};
  canvas.picture.create(std::max(canvas.query_place.height, canvas.match_place.height), 2 * image_width_px + kPairGapPx, CV_8UC3);
  canvas.picture.setTo(plot::kPaper);
  backdrop(query_gray, canvas.query_place.size()).copyTo(canvas.picture(canvas.query_place));
  backdrop(match_gray, canvas.match_place.size()).copyTo(canvas.picture(canvas.match_place));
  return canvas;
}

}  // namespace fabloop
