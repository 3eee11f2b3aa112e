// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/dot_products.h"

#include <cstring>

namespace fabloop {
namespace {

/// Eight floats; the compiler uses whatever registers the function's target has.
using Vector8 = float __attribute__((vector_size(32)));

constexpr std::size_t kRows = 6;  ///< With two vectors a row, twelve accumulators: as many as sixteen registers can hold.

#if defined(__GNUC__)
#define FABLOOP_ALWAYS_INLINE inline __attribute__((always_inline))
#else
#define FABLOOP_ALWAYS_INLINE inline
#endif

template <std::size_t kNumRows>
FABLOOP_ALWAYS_INLINE void tile(const float* rows, std::size_t dimension, const float* panel, float* products,
                                std::size_t stride) {
  Vector8 sums[kNumRows][2] = {};
  for (std::size_t d = 0; d < dimension; ++d) {
    Vector8 low, high;
    std::memcpy(&low, panel + d * kPanelWidth, sizeof low);
    std::memcpy(&high, panel + d * kPanelWidth + 8, sizeof high);
    for (std::size_t r = 0; r < kNumRows; ++r) {
      const float value = rows[r * dimension + d];
      sums[r][0] += value * low;
      sums[r][1] += value * high;
    }
  }
  for (std::size_t r = 0; r < kNumRows; ++r) std::memcpy(products + r * stride, sums[r], sizeof sums[r]);
}

FABLOOP_ALWAYS_INLINE void all_rows(const float* rows, std::size_t num_rows, std::size_t dimension, const float* panel,
                                    float* products, std::size_t stride) {
  std::size_t r = 0;
  for (; r + kRows <= num_rows; r += kRows) tile<kRows>(rows + r * dimension, dimension, panel, products + r * stride, stride);
  for (; r < num_rows; ++r) tile<1>(rows + r * dimension, dimension, panel, products + r * stride, stride);
}

void dot_products_baseline(const float* rows, std::size_t num_rows, std::size_t dimension, const float* panel, float* products,
                           std::size_t stride) {
  all_rows(rows, num_rows, dimension, panel, products, stride);
}

#if defined(__x86_64__)
__attribute__((target("avx2,fma"))) void dot_products_avx2(const float* rows, std::size_t num_rows, std::size_t dimension,
                                                           const float* panel, float* products, std::size_t stride) {
  all_rows(rows, num_rows, dimension, panel, products, stride);
}
#endif

using Kernel = void (*)(const float*, std::size_t, std::size_t, const float*, float*, std::size_t);

Kernel fastest_kernel() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return dot_products_avx2;
#endif
  return dot_products_baseline;
}

}  // namespace

void dot_products(const float* rows, std::size_t num_rows, std::size_t dimension, const float* panel, float* products,
                  std::size_t stride) {
  static const Kernel kernel = fastest_kernel();
  kernel(rows, num_rows, dimension, panel, products, stride);
}

}  // namespace fabloop
