// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/dominant_angle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace fabloop {
namespace {

constexpr int kBins = 36;
constexpr float kDegreesPerBin = 360.0F / kBins;

using Histogram = std::array<float, kBins>;

float at(const Histogram& histogram, int bin) { return histogram[static_cast<std::size_t>((bin + 2 * kBins) % kBins)]; }

Histogram smoothed(const Histogram& raw) {
  Histogram result{};
  for (int i = 0; i < kBins; ++i) {
    result[static_cast<std::size_t>(i)] =
        (at(raw, i - 2) + at(raw, i + 2) + 4.0F * (at(raw, i - 1) + at(raw, i + 1)) + 6.0F * at(raw, i)) / 16.0F;
  }
  return result;
}

Histogram gradient_histogram(const cv::Mat& image, const cv::Point2f& centre, float size) {
  const float sigma = std::max(1.0F, size / 2.0F);
  const int step = std::max(1, static_cast<int>(std::lround(sigma / 2.0F)));
  const int reach = static_cast<int>(std::lround(4.5F * sigma)) / step;
  const float weight_exponent = -1.0F / (2.0F * 1.5F * 1.5F * sigma * sigma);
  const int x0 = static_cast<int>(std::lround(centre.x)), y0 = static_cast<int>(std::lround(centre.y));
  Histogram histogram{};
  for (int j = -reach; j <= reach; ++j) {
    const int y = y0 + j * step;
    if (y - step < 0 || y + step >= image.rows) continue;
    for (int i = -reach; i <= reach; ++i) {
      const int x = x0 + i * step;
      if (x - step < 0 || x + step >= image.cols) continue;
      const auto dx = static_cast<float>(image.at<std::uint8_t>(y, x + step) - image.at<std::uint8_t>(y, x - step));
      const auto dy = static_cast<float>(image.at<std::uint8_t>(y + step, x) - image.at<std::uint8_t>(y - step, x));
      const float weight = std::exp(static_cast<float>((i * i + j * j) * step * step) * weight_exponent);
      const int bin = static_cast<int>(std::lround(cv::fastAtan2(dy, dx) / kDegreesPerBin)) % kBins;
      histogram[static_cast<std::size_t>(bin)] += weight * std::sqrt(dx * dx + dy * dy);
    }
  }
  return histogram;
}

}  // namespace

float dominant_angle(const cv::Mat& blurred, const cv::Point2f& centre, float size) {
  const Histogram histogram = smoothed(gradient_histogram(blurred, centre, size));
  const int peak = static_cast<int>(std::max_element(histogram.begin(), histogram.end()) - histogram.begin());
  const float before = at(histogram, peak - 1), middle = at(histogram, peak), after = at(histogram, peak + 1);
  const float curvature = before - 2.0F * middle + after;
  const float offset = curvature < 0 ? 0.5F * (before - after) / curvature : 0.0F;
  const float angle = (static_cast<float>(peak) + offset) * kDegreesPerBin;
  return angle < 0 ? angle + 360.0F : (angle >= 360.0F ? angle - 360.0F : angle);
}

}  // namespace fabloop
