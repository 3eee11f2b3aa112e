// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/feature_picture.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "frontend/drawing.h"
#include "frontend/features/detectors.h"

namespace fabloop {
namespace {

constexpr double kLeastSizePx = 3.0, kMostSizePx = 96.0;  ///< Ends of the colour scale.
constexpr int kCaptionHeight = 34;

/// From yellow (small) to blue (large), by the size's logarithm.
std::vector<cv::Scalar> make_colours() {
  cv::Mat1b ramp(1, 256);
  for (int i = 0; i < 256; ++i) ramp(0, i) = static_cast<std::uint8_t>(215 - i * 160 / 255);
  cv::Mat3b colours;
  cv::applyColorMap(ramp, colours, cv::COLORMAP_TURBO);
  std::vector<cv::Scalar> result;
  for (int i = 0; i < 256; ++i) result.emplace_back(colours(0, i));
  return result;
}

const cv::Scalar& colour_of(const std::vector<cv::Scalar>& colours, double size) {
  const double share = std::log(size / kLeastSizePx) / std::log(kMostSizePx / kLeastSizePx);
  return colours[static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * static_cast<double>(colours.size() - 1))];
}

/// The image dimmed and scaled, for colours to stand out on it.
cv::Mat backdrop(const cv::Mat& gray, double scale) {
  cv::Mat scaled, colour;
  const cv::Size size(std::max(1, cvRound(scale * gray.cols)), std::max(1, cvRound(scale * gray.rows)));
  cv::resize(gray, scaled, size, 0, 0, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  scaled.convertTo(scaled, CV_8U, 0.7);
  cv::cvtColor(scaled, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

void draw_keypoint(cv::Mat& picture, const cv::KeyPoint& keypoint, double size, double scale, const cv::Scalar& colour) {
  const cv::Point2d centre((keypoint.pt.x + 0.5) * scale - 0.5, (keypoint.pt.y + 0.5) * scale - 0.5);
  const double radius = std::max(2.0, 0.5 * size * scale);
  draw::circle(picture, centre, radius, colour);
  if (keypoint.angle < 0) return;
  const double angle = keypoint.angle * CV_PI / 180.0;
  const cv::Point2d tip = centre + radius * cv::Point2d(std::cos(angle), std::sin(angle));
  draw::line(picture, centre, tip, colour);
}

/// The title to the left, and what the colours mean to the right.
cv::Mat caption(int width, const std::string& title, const std::vector<cv::Scalar>& colours) {
  cv::Mat strip(kCaptionHeight, width, CV_8UC3, cv::Scalar::all(255));
  const cv::Scalar ink = cv::Scalar::all(30);
  constexpr int kBaseline = 23;
  constexpr std::array<int, 4> kSizes = {4, 8, 16, 32};
  constexpr int kStep = 52;
  int x = width - static_cast<int>(kSizes.size()) * kStep - 92;
  cv::putText(strip, title, {10, kBaseline}, cv::FONT_HERSHEY_SIMPLEX, 0.6, ink, 1, cv::LINE_AA);
  const int title_width = cv::getTextSize(title, cv::FONT_HERSHEY_SIMPLEX, 0.6, 1, nullptr).width;
  if (x < title_width + 30) return strip;
  cv::putText(strip, "size [px]", {x, kBaseline}, cv::FONT_HERSHEY_SIMPLEX, 0.5, ink, 1, cv::LINE_AA);
  x += 84;
  for (const int size : kSizes) {
    cv::circle(strip, {x + 8, kBaseline - 5}, 7, colour_of(colours, size), cv::FILLED, cv::LINE_AA);
    cv::putText(strip, std::to_string(size), {x + 20, kBaseline}, cv::FONT_HERSHEY_SIMPLEX, 0.5, ink, 1, cv::LINE_AA);
    x += kStep;
  }
  return strip;
}

}  // namespace

cv::Mat draw_features(const cv::Mat& gray, const FeatureKind& kind, const std::vector<cv::KeyPoint>& keypoints,
                      const std::string& title, const FeaturePictureOptions& options) {
  assert(!gray.empty() && gray.type() == CV_8UC1);
  const double scale = static_cast<double>(options.longer_side_px) / std::max(gray.cols, gray.rows);
  const std::vector<cv::Scalar> colours = make_colours();
  cv::Mat picture = backdrop(gray, scale);
  // The large first, so that they do not hide the small.
  std::vector<std::pair<double, const cv::KeyPoint*>> by_size;
  for (const cv::KeyPoint& keypoint : keypoints) by_size.emplace_back(spot_size(kind.detector, keypoint), &keypoint);
  std::stable_sort(by_size.begin(), by_size.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [size, keypoint] : by_size) draw_keypoint(picture, *keypoint, size, scale, colour_of(colours, size));
  cv::Mat with_caption;
  cv::vconcat(picture, caption(picture.cols, title, colours), with_caption);
  return with_caption;
}

cv::Mat montage(const std::vector<cv::Mat>& pictures, int columns, int picture_width_px) {
  assert(!pictures.empty() && columns > 0);
  constexpr int kGap = 8;
  std::vector<cv::Mat> scaled(pictures.size());
  int height = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const double scale = static_cast<double>(picture_width_px) / pictures[i].cols;
    cv::resize(pictures[i], scaled[i], {picture_width_px, std::max(1, cvRound(scale * pictures[i].rows))}, 0, 0, cv::INTER_AREA);
    height = std::max(height, scaled[i].rows);
  }
  const int used_columns = std::min(columns, static_cast<int>(pictures.size()));
  const int rows = (static_cast<int>(pictures.size()) + columns - 1) / columns;
  cv::Mat result(rows * (height + kGap) + kGap, used_columns * (picture_width_px + kGap) + kGap, CV_8UC3, cv::Scalar::all(255));
  for (std::size_t i = 0; i < scaled.size(); ++i) {
    const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
    const cv::Rect place(kGap + column * (picture_width_px + kGap), kGap + row * (height + kGap), picture_width_px,
                         scaled[i].rows);
    scaled[i].copyTo(result(place));
  }
  return result;
}

}  // namespace fabloop
