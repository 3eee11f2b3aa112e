// SPDX-License-Identifier: BSD-3-Clause
#include "data/noise.h"

#include <cmath>

namespace fabloop {
namespace {

/// A value in [-1, 1] of a point of the lattice.
float lattice_value(std::int32_t x, std::int32_t y, std::uint32_t seed) {
  std::uint32_t h = seed ^ (static_cast<std::uint32_t>(x) * 0x9E3779B1U) ^ (static_cast<std::uint32_t>(y) * 0x85EBCA77U);
  h = (h ^ (h >> 15)) * 0x2C1B3C6DU;
  h = (h ^ (h >> 12)) * 0x297A2D39U;
  h ^= h >> 15;
  return static_cast<float>(static_cast<std::int32_t>(h)) * 0x1.0p-31F;
}

float blend(float a, float b, float t) { return a + (b - a) * t; }

/// std::floor is a function call without SSE4.1, and this is the innermost loop.
std::int32_t floor_to_int(float x) {
  const auto truncated = static_cast<std::int32_t>(x);
  return truncated - (x < static_cast<float>(truncated) ? 1 : 0);
}

}  // namespace

float value_noise(float x, float y, std::uint32_t seed) {
  const std::int32_t ix = floor_to_int(x);
  const std::int32_t iy = floor_to_int(y);
  const float fx = x - static_cast<float>(ix);
  const float fy = y - static_cast<float>(iy);
  const float sx = fx * fx * (3.0F - 2.0F * fx);
  const float sy = fy * fy * (3.0F - 2.0F * fy);
  const float top = blend(lattice_value(ix, iy, seed), lattice_value(ix + 1, iy, seed), sx);
  const float bottom = blend(lattice_value(ix, iy + 1, seed), lattice_value(ix + 1, iy + 1, seed), sx);
  return blend(top, bottom, sy);
}

float fractal_noise(float x, float y, int octaves, std::uint32_t seed) {
  // 2 cos and 2 sin of 37 degrees: twice the frequency, and turned.
  constexpr float kCos2 = 1.5973F;
  constexpr float kSin2 = 1.2036F;
  float sum = 0.0F;
  float amplitude = 1.0F;
  float total = 0.0F;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += amplitude * value_noise(x, y, seed + static_cast<std::uint32_t>(octave) * 0x68E31DA4U);
    total += amplitude;
    amplitude *= 0.5F;
    const float turned_x = kCos2 * x - kSin2 * y + 13.7F;
    y = kSin2 * x + kCos2 * y + 7.3F;
    x = turned_x;
  }
  return sum / total;
}

double line_noise(double x, std::uint32_t seed) {
  const double floor_x = std::floor(x);
  const auto i = static_cast<std::int32_t>(floor_x);
  const double f = x - floor_x;
  const double s = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
  const double a = lattice_value(i, 0, seed);
  const double b = lattice_value(i + 1, 0, seed);
  return a + (b - a) * s;
}

}  // namespace fabloop
