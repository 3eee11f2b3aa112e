// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace fabloop {

/// A regular octagon on the pixel grid: |x| <= radius, |y| <= radius, |x| + |y| <= 2 radius - cut.
struct Octagon {
  explicit Octagon(int octagon_radius);
  int radius;
  int cut;  ///< Pixels that each corner lacks along the border: (2 - sqrt 2) radius, rounded.
  int num_pixels;
};

/// Sums of a grey image over octagons in constant time, by slanted integral images (Agrawal et al. 2008, section 3.2): an
/// octagon is a trapezoid, a rectangle and a trapezoid.
class OctagonSums {
 public:
  /// Takes an 8-bit grey image (`CV_8UC1`).
  explicit OctagonSums(const cv::Mat& gray);

  /// The sum over the octagon at (x, y), which must lie in the image.
  std::uint32_t sum(const Octagon& octagon, int x, int y) const {
    const int half = octagon.radius - octagon.cut;  // of the shortest rows' length, and of the number of longest rows
    return growing(x - half, x + half, y - octagon.radius, octagon.cut) +
           box(x - octagon.radius, x + octagon.radius, y - half, y + half) +
           shrinking(x - half, x + half, y + octagon.radius, octagon.cut);
  }

 private:
  /// One integral image. Coordinates start at -1; sums wrap around at 2^32, and differences come out right.
  struct Plane {
    std::size_t stride = 0;
    std::vector<std::uint32_t> sums;
    std::uint32_t& at(int x, int y) { return sums[static_cast<std::size_t>(y + 1) * stride + static_cast<std::size_t>(x + 1)]; }
    std::uint32_t at(int x, int y) const {
      return sums[static_cast<std::size_t>(y + 1) * stride + static_cast<std::size_t>(x + 1)];
    }
  };

  std::uint32_t box(int left, int right, int top, int bottom) const {
    return straight_.at(right, bottom) - straight_.at(left - 1, bottom) - straight_.at(right, top - 1) +
           straight_.at(left - 1, top - 1);
  }
  /// `rows` rows from `top` on, the first from left to right, each one pixel longer at both ends than the one above.
  std::uint32_t growing(int left, int right, int top, int rows) const {
    const int last = top + rows - 1;
    return narrowing_.at(right + rows - 1, last) - narrowing_.at(right - 1, top - 1) - widening_.at(left - rows, last) +
           widening_.at(left, top - 1);
  }
  /// `rows` rows that end at `bottom`, the last from left to right, each one pixel shorter at both ends than the one above.
  std::uint32_t shrinking(int left, int right, int bottom, int rows) const {
    const int before = bottom - rows;
    return widening_.at(right, bottom) - widening_.at(right + rows, before) - narrowing_.at(left - 1, bottom) +
           narrowing_.at(left - 1 - rows, before);
  }

  Plane straight_;   ///< At (x, y): the pixels with x' <= x, y' <= y.
  Plane widening_;   ///< x' <= x + (y - y'): the edge leans to the right going up.
  Plane narrowing_;  ///< x' <= x - (y - y'): to the left.
};

}  // namespace fabloop
