// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// Scrambles 64 bits (Steele et al., "Fast splittable pseudorandom number generators", OOPSLA 2014: SplitMix64's finaliser).
inline constexpr std::uint64_t scramble(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

/// Random numbers that are the same on every platform (the standard library's distributions are not). `stream` makes
/// independent generators of one seed: one for each frame, say, so that frames can be made in any order.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : state_(scramble(scramble(seed) ^ stream)) {}

  std::uint64_t bits() { return scramble(state_++); }

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Normal with mean 0 and standard deviation 1 (Box and Muller 1958).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * kPi * uniform());
  }

  /// -1 or 1.
  double sign() { return (bits() & 1) != 0 ? 1.0 : -1.0; }

 private:
  std::uint64_t state_;
};

}  // namespace fabloop
