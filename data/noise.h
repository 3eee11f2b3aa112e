// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace fabloop {

/// Smooth random values over the plane ("value noise"): independent uniform values in [-1, 1] at integer coordinates, blended
/// between them. The same `seed` gives the same field.
float value_noise(float x, float y, std::uint32_t seed);

/// Sum of `octaves` of value_noise, each of half the wavelength and half the amplitude of the one before, and turned against
/// it so that no grid can be seen. In [-1, 1], standard deviation about 0.3. The first octave's wavelength is 1.
float fractal_noise(float x, float y, int octaves, std::uint32_t seed);

/// Smooth random values along a line, in [-1, 1], wavelength 1.
double line_noise(double x, std::uint32_t seed);

/// 0 below `low`, 1 above `high`, smooth between.
inline float smooth_step(float low, float high, float x) {
  const float t = (x - low) / (high - low);
  if (t <= 0.0F) return 0.0F;
  if (t >= 1.0F) return 1.0F;
  return t * t * (3.0F - 2.0F * t);
}

}  // namespace fabloop
