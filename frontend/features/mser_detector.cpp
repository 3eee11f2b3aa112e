// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/mser_detector.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace fabloop {
namespace {

cv::Rect grown_by_half(const cv::Rect& box, const cv::Size& image) {
  const int dx = std::max(1, box.width / 4), dy = std::max(1, box.height / 4);
  return cv::Rect(box.x - dx, box.y - dy, box.width + 2 * dx, box.height + 2 * dy) & cv::Rect(cv::Point(), image);
}

double sum_in(const cv::Mat1d& integral, const cv::Rect& box) {
  return integral(box.y + box.height, box.x + box.width) - integral(box.y, box.x + box.width) -
         integral(box.y + box.height, box.x) + integral(box.y, box.x);
}

cv::KeyPoint keypoint_of(const std::vector<cv::Point>& region, const cv::Rect& box, const cv::Mat& gray,
                         const cv::Mat1d& integral) {
  double x = 0, y = 0, grey = 0;
  for (const cv::Point& pixel : region) x += pixel.x, y += pixel.y, grey += gray.at<std::uint8_t>(pixel);
  const auto count = static_cast<double>(region.size());
  x /= count, y /= count;
  double xx = 0, xy = 0, yy = 0;
  for (const cv::Point& pixel : region) {
    const double dx = pixel.x - x, dy = pixel.y - y;
    xx += dx * dx, xy += dx * dy, yy += dy * dy;
  }
  // An ellipse with semi-axes a and b has second moments a^2 / 4 and b^2 / 4, and a circle of its area the diameter 2 sqrt(a b).
  const double determinant = std::max(0.0, (xx * yy - xy * xy) / (count * count));
  const double diameter = std::max(1.0, 4.0 * std::pow(determinant, 0.25));
  const cv::Rect around = grown_by_half(box, gray.size());
  const double rest = around.area() - count;
  const double contrast = rest > 0 ? std::abs(grey / count - (sum_in(integral, around) - grey) / rest) : 0.0;
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(diameter), -1.0F, static_cast<float>(contrast)};
}

}  // namespace

std::vector<cv::KeyPoint> detect_mser(const cv::Mat& gray, const MserOptions& options, double threshold) {
  const auto mser =
      cv::MSER::create(options.delta, options.min_area_px, options.max_area_px, options.max_variation, options.min_diversity);
  std::vector<std::vector<cv::Point>> regions;
  std::vector<cv::Rect> boxes;
  mser->detectRegions(gray, regions, boxes);
  cv::Mat1d integral;
  cv::integral(gray, integral, CV_64F);
  std::vector<cv::KeyPoint> keypoints;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const cv::KeyPoint keypoint = keypoint_of(regions[i], boxes[i], gray, integral);
    if (keypoint.response > 0 && keypoint.response >= threshold) keypoints.push_back(keypoint);
  }
  return keypoints;
}

}  // namespace fabloop
