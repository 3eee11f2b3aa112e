// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

namespace fabloop {

/// How a sample was drawn: from the first data, with the last of them or without regard to it.
struct ProsacDraw {
  std::size_t subset = 0;
  bool has_newest = false;
};

/// Draws samples from the best data first and from more and more of them later: PROSAC (Chum & Matas, CVPR 2005), for data
/// sorted by quality, best first. After `uniform_after` draws in order (Chum & Matas' T_N) it draws uniformly from all.
/// Once it is known which of the first data are rich in inliers, every other sample comes from those, besides.
template <std::size_t kSize>
class ProsacSampler {
 public:
  using Sample = std::array<std::size_t, kSize>;

  ProsacSampler(std::size_t num_data, double uniform_after, std::uint64_t seed)
      : num_data_(num_data), rich_(num_data), subset_(kSize), draws_(uniform_after), random_(seed) {
    for (std::size_t i = 0; i < kSize; ++i) draws_ *= static_cast<double>(kSize - i) / static_cast<double>(num_data - i);
  }

  Sample next() {
    is_rich_turn_ = !is_rich_turn_ && rich_ < subset_;
    if (is_rich_turn_) return drawn({rich_, false});
    ++iteration_;
    if (iteration_ > grow_at_ && subset_ < num_data_) {  // eq. 3 and 4
      const double more = draws_ * static_cast<double>(subset_ + 1) / static_cast<double>(subset_ + 1 - kSize);
      grow_at_ += std::ceil(more - draws_);
      draws_ = more;
      ++subset_;
    }
    return drawn({subset_, subset_ < num_data_});
  }

  /// Of how many of the first data samples are good most often.
  void set_rich(std::size_t num_first) { rich_ = num_first; }

  /// How many samples were drawn in order, not from the rich ones.
  double num_in_order() const { return iteration_; }

  /// How the last sample was drawn.
  ProsacDraw draw() const { return draw_; }

 private:
  Sample drawn(ProsacDraw draw) {
    draw_ = draw;
    Sample sample{};
    const std::size_t count = draw.has_newest ? kSize - 1 : kSize;
    for (std::size_t i = 0; i < count;) {
      sample[i] = uniform(draw.has_newest ? draw.subset - 1 : draw.subset);
      const auto end = sample.begin() + static_cast<std::ptrdiff_t>(i);
      if (std::find(sample.begin(), end, sample[i]) == end) ++i;
    }
    if (draw.has_newest) sample[kSize - 1] = draw.subset - 1;
    return sample;
  }

  /// In [0, bound). The standard's distributions differ between libraries; this one is the same everywhere.
  std::size_t uniform(std::size_t bound) { return static_cast<std::size_t>(random_() % bound); }

  std::size_t num_data_;
  std::size_t rich_;
  std::size_t subset_;
  bool is_rich_turn_ = false;
  ProsacDraw draw_;
  double draws_;
  double grow_at_ = 1;
  double iteration_ = 0;
  std::mt19937_64 random_;
};

}  // namespace fabloop
