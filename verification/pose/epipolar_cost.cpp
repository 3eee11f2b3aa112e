// SPDX-License-Identifier: BSD-3-Clause
// No Eigen here: functions of this unit are compiled for several processors, and inline functions of a header would be too.
#include "verification/pose/epipolar_cost.h"

#include <cstring>

namespace fabloop {
namespace {

constexpr std::size_t kLanes = 8;
/// The bound is looked at once in so many vectors.
constexpr std::size_t kVectorsPerLook = 4;
constexpr std::size_t kBlock = kLanes * kVectorsPerLook;

typedef float Lanes __attribute__((vector_size(kLanes * sizeof(float))));

#define FABLOOP_INLINE static inline __attribute__((always_inline))

FABLOOP_INLINE void load(const float* from, Lanes& lanes) { std::memcpy(&lanes, from, sizeof lanes); }

FABLOOP_INLINE double sum_of_costs(const float* data, std::size_t padded, const float* e, float inverse_squared_threshold,
                                   double bound) {
  double cost = 0;
  const Lanes one = 1.0F - Lanes{};
  for (std::size_t first = 0; first < padded && cost <= bound; first += kBlock) {
    Lanes sum = {};
    for (std::size_t i = first; i < first + kBlock; i += kLanes) {
      Lanes qx, qy, qz, mx, my, mz;
      load(data + i, qx);
      load(data + padded + i, qy);
      load(data + 2 * padded + i, qz);
      load(data + 3 * padded + i, mx);
      load(data + 4 * padded + i, my);
      load(data + 5 * padded + i, mz);
      const Lanes fx = e[0] * qx + e[1] * qy + e[2] * qz;
      const Lanes fy = e[3] * qx + e[4] * qy + e[5] * qz;
      const Lanes fz = e[6] * qx + e[7] * qy + e[8] * qz;
      const Lanes gx = e[0] * mx + e[3] * my + e[6] * mz;
      const Lanes gy = e[1] * mx + e[4] * my + e[7] * mz;
      const Lanes gz = e[2] * mx + e[5] * my + e[8] * mz;
      const Lanes error = mx * fx + my * fy + mz * fz;
      const Lanes squared = error * error;
      const Lanes gradient = fx * fx + fy * fy + fz * fz + gx * gx + gy * gy + gz * gz - 2.0F * squared;
      const Lanes scaled = squared * inverse_squared_threshold;
      // Zero rays have neither an error nor a gradient, and cost nothing.
      sum += scaled < gradient ? scaled / gradient : (scaled > 0.0F ? one : Lanes{});
    }
    float total = 0;
    for (std::size_t l = 0; l < kLanes; ++l) total += sum[l];
    cost += static_cast<double>(total);
  }
  return cost;
}

using Kernel = double (*)(const float*, std::size_t, const float*, float, double);

double cost_baseline(const float* data, std::size_t padded, const float* e, float inverse_squared_threshold, double bound) {
  return sum_of_costs(data, padded, e, inverse_squared_threshold, bound);
}

#if defined(__x86_64__)
__attribute__((target("avx2,fma"))) double cost_avx2(const float* data, std::size_t padded, const float* e,
                                                     float inverse_squared_threshold, double bound) {
  return sum_of_costs(data, padded, e, inverse_squared_threshold, bound);
}
#endif

Kernel fastest_kernel() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return cost_avx2;
#endif
  return cost_baseline;
}

}  // namespace

EpipolarData::EpipolarData(std::size_t num_pairs)
    : size_(num_pairs), padded_((num_pairs + kBlock - 1) / kBlock * kBlock), coordinates_(6 * padded_, 0.0F) {}

void EpipolarData::set(std::size_t i, const double* query_ray, const double* match_ray) {
  for (std::size_t k = 0; k < 3; ++k) {
    coordinates_[k * padded_ + i] = static_cast<float>(query_ray[k]);
    coordinates_[(3 + k) * padded_ + i] = static_cast<float>(match_ray[k]);
  }
}

double EpipolarData::cost(const std::array<double, 9>& essential, double max_error_rad, double bound) const {
  static const Kernel kernel = fastest_kernel();
  std::array<float, 9> e{};
  for (std::size_t i = 0; i < 9; ++i) e[i] = static_cast<float>(essential[i]);
  return kernel(coordinates_.data(), padded_, e.data(), static_cast<float>(1.0 / (max_error_rad * max_error_rad)), bound);
}

}  // namespace fabloop
