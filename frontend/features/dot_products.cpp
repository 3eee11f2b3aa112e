// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/dot_products.h"

#include <cstring>

namespace fabloop {
namespace {

/// Eight floats; the compiler uses whatever registers the function's target has.
using Vector8 = float __attribute__((vector_size(32)));
using Vector4 = double __attribute__((vector_size(32)));
using Mask8 = std::int32_t __attribute__((vector_size(32)));

constexpr std::size_t kRows = 6;  ///< With two vectors a row, twelve accumulators: as many as sixteen registers can hold.
constexpr std::size_t kLanes = 8;

#if defined(__GNUC__)
#define FABLOOP_ALWAYS_INLINE inline __attribute__((always_inline))
#else
#define FABLOOP_ALWAYS_INLINE inline
#endif

template <std::size_t kNumRows>
struct Sums {
  Vector8 of_row[kNumRows][2] = {};
};

template <std::size_t kNumRows>
FABLOOP_ALWAYS_INLINE void add_products(const float* rows, std::size_t dimension, const float* panel, Sums<kNumRows>& sums) {
  for (std::size_t d = 0; d < dimension; ++d) {
    Vector8 low, high;
    std::memcpy(&low, panel + d * kPanelWidth, sizeof low);
    std::memcpy(&high, panel + d * kPanelWidth + kLanes, sizeof high);
    for (std::size_t r = 0; r < kNumRows; ++r) {
      const float value = rows[r * dimension + d];
      sums.of_row[r][0] += value * low;
      sums.of_row[r][1] += value * high;
    }
  }
}

/// Keeps the products.
struct Store {
  float* products;
  std::size_t stride;

  template <std::size_t kNumRows>
  FABLOOP_ALWAYS_INLINE void finish(std::size_t first_row, const Sums<kNumRows>& sums) const {
    for (std::size_t r = 0; r < kNumRows; ++r) {
      std::memcpy(products + (first_row + r) * stride, sums.of_row[r], sizeof sums.of_row[r]);
    }
  }
};

/// Keeps which of them are within the row's limit.
struct Compare {
  const float* limits;
  PanelHit* hits;
  std::size_t* num_hits;

  template <std::size_t kNumRows>
  FABLOOP_ALWAYS_INLINE void finish(std::size_t first_row, const Sums<kNumRows>& sums) const {
    Mask8 within[kNumRows][2];
    Mask8 any = {};
    for (std::size_t r = 0; r < kNumRows; ++r) {
      const float value = limits[first_row + r];
      const Vector8 limit = {value, value, value, value, value, value, value, value};
      within[r][0] = sums.of_row[r][0] <= limit;
      within[r][1] = sums.of_row[r][1] <= limit;
      any |= within[r][0] | within[r][1];
    }
    if (!is_any(any)) return;
    for (std::size_t r = 0; r < kNumRows; ++r) {
      if (!is_any(within[r][0] | within[r][1])) continue;
      std::int32_t lanes[kPanelWidth];
      std::memcpy(lanes, within[r], sizeof lanes);
      std::size_t end = *num_hits;
      for (std::size_t j = 0; j < kPanelWidth; ++j) {  // Branches would be mispredicted.
        hits[end] = {static_cast<std::uint32_t>(first_row + r), static_cast<std::uint32_t>(j)};
        end += static_cast<std::size_t>(lanes[j] & 1);
      }
      *num_hits = end;
    }
  }

  static FABLOOP_ALWAYS_INLINE bool is_any(const Mask8& mask) {
    std::uint64_t parts[4];
    std::memcpy(parts, &mask, sizeof parts);
    return (parts[0] | parts[1] | parts[2] | parts[3]) != 0;
  }
};

template <std::size_t kNumRows, typename Result>
FABLOOP_ALWAYS_INLINE void tile(const float* rows, std::size_t first_row, std::size_t dimension, const float* panel,
                                const Result& result) {
  Sums<kNumRows> sums;
  add_products(rows + first_row * dimension, dimension, panel, sums);
  result.finish(first_row, sums);
}

template <typename Result>
FABLOOP_ALWAYS_INLINE void all_rows(const float* rows, std::size_t num_rows, std::size_t dimension, const float* panel,
                                    const Result& result) {
  std::size_t r = 0;
  for (; r + kRows <= num_rows; r += kRows) tile<kRows>(rows, r, dimension, panel, result);
  switch (num_rows - r) {
    case 1:
      return tile<1>(rows, r, dimension, panel, result);
    case 2:
      return tile<2>(rows, r, dimension, panel, result);
    case 3:
      return tile<3>(rows, r, dimension, panel, result);
    case 4:
      return tile<4>(rows, r, dimension, panel, result);
    case 5:
      return tile<5>(rows, r, dimension, panel, result);
    default:
      return;
  }
}

FABLOOP_ALWAYS_INLINE float sum_of_squares(const float* a, const float* b, std::size_t dimension) {
  constexpr std::size_t kVectors = 4;
  Vector8 sums[kVectors] = {};
  std::size_t d = 0;
  for (; d + kVectors * kLanes <= dimension; d += kVectors * kLanes) {
    for (std::size_t i = 0; i < kVectors; ++i) {
      Vector8 x, y;
      std::memcpy(&x, a + d + i * kLanes, sizeof x);
      std::memcpy(&y, b + d + i * kLanes, sizeof y);
      const Vector8 difference = x - y;
      sums[i] += difference * difference;
    }
  }
  const Vector8 all = (sums[0] + sums[1]) + (sums[2] + sums[3]);
  float rest = 0.0F;
  for (; d < dimension; ++d) rest += (a[d] - b[d]) * (a[d] - b[d]);
  return ((all[0] + all[4]) + (all[1] + all[5])) + ((all[2] + all[6]) + (all[3] + all[7])) + rest;
}

template <std::size_t kVectors>
FABLOOP_ALWAYS_INLINE void add_centred(const float* row, const double* mean, std::size_t dimension, const double* columns,
                                       std::size_t num_columns, double* sums) {
  Vector4 result[kVectors] = {};
  for (std::size_t d = 0; d < dimension; ++d) {
    const double value = static_cast<double>(row[d]) - mean[d];
    for (std::size_t i = 0; i < kVectors; ++i) {
      Vector4 column;
      std::memcpy(&column, columns + d * num_columns + i * 4, sizeof column);
      result[i] += value * column;
    }
  }
  std::memcpy(sums, result, sizeof result);
}

FABLOOP_ALWAYS_INLINE void all_centred(const float* row, const double* mean, std::size_t dimension, const double* columns,
                                       std::size_t num_columns, double* sums) {
  std::size_t first = 0;
  for (; first + 24 <= num_columns; first += 24) add_centred<6>(row, mean, dimension, columns + first, num_columns, sums + first);
  for (; first < num_columns; first += 8) add_centred<2>(row, mean, dimension, columns + first, num_columns, sums + first);
}

struct Kernels {
  void (*store)(const float*, std::size_t, std::size_t, const float*, const Store&);
  void (*compare)(const float*, std::size_t, std::size_t, const float*, const Compare&);
  void (*centred)(const float*, const double*, std::size_t, const double*, std::size_t, double*);
  float (*squared_distance)(const float*, const float*, std::size_t);
};

void store_baseline(const float* rows, std::size_t num_rows, std::size_t dimension, const float* panel, const Store& result) {
  all_rows(rows, num_rows, dimension, panel, result);
}

void compare_baseline(const float* rows, std::size_t num_rows, std::size_t dimension, const float* panel, const Compare& result) {
  all_rows(rows, num_rows, dimension, panel, result);
}

void centred_baseline(const float* row, const double* mean, std::size_t dimension, const double* columns, std::size_t num_columns,
                      double* sums) {
  all_centred(row, mean, dimension, columns, num_columns, sums);
}

float squared_distance_baseline(const float* a, const float* b, std::size_t dimension) { return sum_of_squares(a, b, dimension); }

#if defined(__x86_64__)
#define FABLOOP_AVX2 __attribute__((target("avx2,fma")))

FABLOOP_AVX2 void store_avx2(const float* rows, std::size_t num_rows, std::size_t dimension, const float* panel,
                             const Store& result) {
  all_rows(rows, num_rows, dimension, panel, result);
}

FABLOOP_AVX2 void compare_avx2(const float* rows, std::size_t num_rows, std::size_t dimension, const float* panel,
                               const Compare& result) {
  all_rows(rows, num_rows, dimension, panel, result);
}

FABLOOP_AVX2 void centred_avx2(const float* row, const double* mean, std::size_t dimension, const double* columns,
                               std::size_t num_columns, double* sums) {
  all_centred(row, mean, dimension, columns, num_columns, sums);
}

FABLOOP_AVX2 float squared_distance_avx2(const float* a, const float* b, std::size_t dimension) {
  return sum_of_squares(a, b, dimension);
}
#undef FABLOOP_AVX2
#endif

Kernels fastest_kernels() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    return {store_avx2, compare_avx2, centred_avx2, squared_distance_avx2};
#endif
  return {store_baseline, compare_baseline, centred_baseline, squared_distance_baseline};
}

const Kernels& kernels() {
  static const Kernels fastest = fastest_kernels();
  return fastest;
}

}  // namespace

void dot_products(const float* rows, std::size_t num_rows, std::size_t dimension, const float* panel, float* products,
                  std::size_t stride) {
  kernels().store(rows, num_rows, dimension, panel, {products, stride});
}

std::size_t dot_products_within(const float* rows, std::size_t num_rows, std::size_t dimension, const float* panel,
                                const float* limits, PanelHit* hits) {
  std::size_t num_hits = 0;
  kernels().compare(rows, num_rows, dimension, panel, {limits, hits, &num_hits});
  return num_hits;
}

void centred_products(const float* row, const double* mean, std::size_t dimension, const double* columns, std::size_t num_columns,
                      double* sums) {
  kernels().centred(row, mean, dimension, columns, num_columns, sums);
}

float squared_distance(const float* a, const float* b, std::size_t dimension) {
  return kernels().squared_distance(a, b, dimension);
}

}  // namespace fabloop
