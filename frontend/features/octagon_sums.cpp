// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/octagon_sums.h"

#include <cassert>
#include <cmath>

namespace fabloop {
namespace {

int pixels_of(int radius, int cut) {
  const int side = 2 * radius + 1;
  return side * side - 2 * cut * (cut + 1);
}

}  // namespace

Octagon::Octagon(int octagon_radius)
    : radius(octagon_radius),
      cut(static_cast<int>(std::lround((2.0 - std::sqrt(2.0)) * octagon_radius))),
      num_pixels(pixels_of(radius, cut)) {}

OctagonSums::OctagonSums(const cv::Mat& gray) {
  assert(gray.type() == CV_8UC1);
  const int width = gray.cols;
  for (Plane* plane : {&straight_, &widening_, &narrowing_}) {
    plane->stride = static_cast<std::size_t>(width) + 1;
    plane->sums.assign(plane->stride * (static_cast<std::size_t>(gray.rows) + 1), 0);
  }
  for (int y = 0; y < gray.rows; ++y) {
    const auto* row = gray.ptr<std::uint8_t>(y);
    std::uint32_t row_sum = 0;
    widening_.at(-1, y) = widening_.at(0, y - 1);
    for (int x = 0; x < width; ++x) {
      row_sum += row[x];
      straight_.at(x, y) = row_sum + straight_.at(x, y - 1);
      narrowing_.at(x, y) = row_sum + narrowing_.at(x - 1, y - 1);
      // Beyond the image's right edge nothing is added, so the sum there is that at the edge.
      widening_.at(x, y) = row_sum + widening_.at(x + 1 < width ? x + 1 : x, y - 1);
    }
  }
}

}  // namespace fabloop
