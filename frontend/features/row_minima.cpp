// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/row_minima.h"

#include <cassert>
#include <cstdint>
#include <cstring>
#include <limits>

namespace fabloop {
namespace {

/// Eight floats; the compiler uses whatever registers the function's target has.
using Vector8 = float __attribute__((vector_size(32)));
using Mask8 = std::int32_t __attribute__((vector_size(32)));

constexpr std::size_t kMinimaLanes = 8;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

#if defined(__GNUC__)
#define FABLOOP_ALWAYS_INLINE inline __attribute__((always_inline))
#else
#define FABLOOP_ALWAYS_INLINE inline
#endif

FABLOOP_ALWAYS_INLINE void load(const float* from, Vector8& to) { std::memcpy(&to, from, sizeof to); }
FABLOOP_ALWAYS_INLINE void store(const Vector8& from, float* to) { std::memcpy(to, &from, sizeof from); }
FABLOOP_ALWAYS_INLINE void lower(Vector8& least, const Vector8& values) { least = values < least ? values : least; }

FABLOOP_ALWAYS_INLINE void fill(float value, Vector8& to) {
  to = Vector8{value, value, value, value, value, value, value, value};
}

FABLOOP_ALWAYS_INLINE float least_lane(Vector8 a, const Vector8& b) {
  lower(a, b);
  float least = kInfinity;
  for (std::size_t lane = 0; lane < kMinimaLanes; ++lane) least = a[lane] < least ? a[lane] : least;
  return least;
}

FABLOOP_ALWAYS_INLINE void to_distances(float* values, std::size_t size, float squared_norm, const float* squared_norms) {
  Vector8 norm;
  fill(squared_norm, norm);
  const Vector8 zero = {};
  for (std::size_t i = 0; i < size; i += kMinimaLanes) {
    Vector8 product, norms;
    load(values + i, product);
    load(squared_norms + i, norms);
    const Vector8 distance = (norm + norms) - 2.0F * product;
    store(zero < distance ? distance : zero, values + i);
  }
}

FABLOOP_ALWAYS_INLINE float least(const float* values, std::size_t size) {
  Vector8 a, b, low, high;
  fill(kInfinity, low);
  fill(kInfinity, high);
  for (std::size_t i = 0; i < size; i += kRowStep) {
    load(values + i, a);
    load(values + i + kMinimaLanes, b);
    lower(low, a);
    lower(high, b);
  }
  return least_lane(low, high);
}

FABLOOP_ALWAYS_INLINE float least_and_lower(const float* values, std::size_t size, float* minima) {
  Vector8 a, minimum, low;
  fill(kInfinity, low);
  for (std::size_t i = 0; i < size; i += kMinimaLanes) {
    load(values + i, a);
    load(minima + i, minimum);
    lower(low, a);
    lower(minimum, a);
    store(minimum, minima + i);
  }
  return least_lane(low, low);
}

FABLOOP_ALWAYS_INLINE std::size_t find(const float* values, std::size_t size, float value) {
  Vector8 wanted, a, b;
  fill(value, wanted);
  for (std::size_t i = 0; i < size; i += kRowStep) {
    load(values + i, a);
    load(values + i + kMinimaLanes, b);
    const Mask8 equal = (a == wanted) | (b == wanted);
    std::uint64_t parts[4];
    std::memcpy(parts, &equal, sizeof parts);
    if ((parts[0] | parts[1] | parts[2] | parts[3]) == 0) continue;
    while (values[i] != value) ++i;
    return i;
  }
  return size;
}

struct MinimaKernels {
  void (*to_distances)(float*, std::size_t, float, const float*);
  float (*least)(const float*, std::size_t);
  float (*least_and_lower)(const float*, std::size_t, float*);
  std::size_t (*find)(const float*, std::size_t, float);
};

void to_distances_baseline(float* values, std::size_t size, float squared_norm, const float* squared_norms) {
  to_distances(values, size, squared_norm, squared_norms);
}
float least_baseline(const float* values, std::size_t size) { return least(values, size); }
float least_and_lower_baseline(const float* values, std::size_t size, float* minima) {
  return least_and_lower(values, size, minima);
}
std::size_t find_baseline(const float* values, std::size_t size, float value) { return find(values, size, value); }

#if defined(__x86_64__)
#define FABLOOP_AVX2 __attribute__((target("avx2")))

FABLOOP_AVX2 void to_distances_avx2(float* values, std::size_t size, float squared_norm, const float* squared_norms) {
  to_distances(values, size, squared_norm, squared_norms);
}
FABLOOP_AVX2 float least_avx2(const float* values, std::size_t size) { return least(values, size); }
FABLOOP_AVX2 float least_and_lower_avx2(const float* values, std::size_t size, float* minima) {
  return least_and_lower(values, size, minima);
}
FABLOOP_AVX2 std::size_t find_avx2(const float* values, std::size_t size, float value) { return find(values, size, value); }
#undef FABLOOP_AVX2
#endif

MinimaKernels fastest_minima_kernels() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return {to_distances_avx2, least_avx2, least_and_lower_avx2, find_avx2};
#endif
  return {to_distances_baseline, least_baseline, least_and_lower_baseline, find_baseline};
}

const MinimaKernels& minima_kernels() {
  static const MinimaKernels fastest = fastest_minima_kernels();
  return fastest;
}

}  // namespace

void squared_distances_from_products(float* values, std::size_t size, float squared_norm, const float* squared_norms) {
  assert(size % kRowStep == 0);
  minima_kernels().to_distances(values, size, squared_norm, squared_norms);
}

float least_of(const float* values, std::size_t size) {
  assert(size % kRowStep == 0);
  return minima_kernels().least(values, size);
}

float least_of_and_lower(const float* values, std::size_t size, float* minima) {
  assert(size % kRowStep == 0);
  return minima_kernels().least_and_lower(values, size, minima);
}

std::size_t first_equal(const float* values, std::size_t size, float value) {
  assert(size % kRowStep == 0);
  return minima_kernels().find(values, size, value);
}

}  // namespace fabloop
