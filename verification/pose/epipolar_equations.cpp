// SPDX-License-Identifier: BSD-3-Clause
// No Eigen here: functions of this unit are compiled for several processors, and inline functions of a header would be too.
#include "verification/pose/epipolar_equations.h"

#include <cmath>
#include <cstring>

// NOLINTBEGIN(cppcoreguidelines-pro-bounds-*)
namespace fabloop {
namespace {

constexpr std::size_t kPairsAtOnce = 4;
constexpr double kBehindRad = 3.14159265358979323846;

typedef double Four __attribute__((vector_size(kPairsAtOnce * sizeof(double))));

#define FABLOOP_INLINE static inline __attribute__((always_inline))

struct Vector {
  Four x, y, z;
};

FABLOOP_INLINE void load(const double* from, Four& lanes) { std::memcpy(&lanes, from, sizeof lanes); }
FABLOOP_INLINE void store(const Four& lanes, double* to) { std::memcpy(to, &lanes, sizeof lanes); }

FABLOOP_INLINE void dot(const Vector& a, const Vector& b, Four& out) { out = a.x * b.x + a.y * b.y + a.z * b.z; }
FABLOOP_INLINE void dot(const double* a, const Vector& b, Four& out) { out = a[0] * b.x + a[1] * b.y + a[2] * b.z; }

FABLOOP_INLINE void cross(const Vector& a, const Vector& b, Vector& out) {
  out = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

FABLOOP_INLINE void product(const double* m, const Vector& v, Vector& out) {
  out = {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z, m[6] * v.x + m[7] * v.y + m[8] * v.z};
}

FABLOOP_INLINE void transposed_product(const double* m, const Vector& v, Vector& out) {
  out = {m[0] * v.x + m[3] * v.y + m[6] * v.z, m[1] * v.x + m[4] * v.y + m[7] * v.z, m[2] * v.x + m[5] * v.y + m[8] * v.z};
}

struct Rays {
  Vector query, match;
};

FABLOOP_INLINE void load_rays(const double* rows, std::size_t padded, std::size_t i, Rays& rays) {
  load(rows + i, rays.query.x);
  load(rows + padded + i, rays.query.y);
  load(rows + 2 * padded + i, rays.query.z);
  load(rows + 3 * padded + i, rays.match.x);
  load(rows + 4 * padded + i, rays.match.y);
  load(rows + 5 * padded + i, rays.match.z);
}

/// As EpipolarResidual.
struct Residuals {
  Vector from_query, from_match;
  Four error, inverse_norm, angle;
};

FABLOOP_INLINE void residuals_of(const Rays& rays, const EpipolarFrame& frame, Residuals& r) {
  constexpr double kMinSquaredGradient = 1e-24;
  product(frame.essential.data(), rays.query, r.from_query);
  transposed_product(frame.essential.data(), rays.match, r.from_match);
  dot(rays.match, r.from_query, r.error);
  Four query_norm, match_norm;
  dot(r.from_query, r.from_query, query_norm);
  dot(r.from_match, r.from_match, match_norm);
  const Four squared = query_norm + match_norm - 2.0 * r.error * r.error;
  for (std::size_t k = 0; k < kPairsAtOnce; ++k) {
    r.inverse_norm[k] = 1.0 / std::sqrt(squared[k] > kMinSquaredGradient ? squared[k] : kMinSquaredGradient);
  }
  r.angle = r.error * r.inverse_norm;
}

/// As epipolar_jacobian(), with the translation's derivative on its tangent plane.
FABLOOP_INLINE void jacobian_of(const Rays& rays, const EpipolarFrame& frame, const Residuals& r, Four (&jacobian)[5]) {
  const auto& [query, match] = rays;
  const double* t = frame.translation.data();
  Vector turned, back, error_by_rotation, error_by_translation, across_query, across_turned;
  product(frame.rotation.data(), query, turned);
  transposed_product(frame.essential.data(), r.from_query, back);
  cross(query, r.from_match, error_by_rotation);
  cross(turned, match, error_by_translation);
  cross(query, back, across_query);
  cross(turned, r.from_query, across_turned);
  Four along;  // match x (t x match) = t - match (match . t) for a unit ray
  dot(t, match, along);
  const Four share = r.angle * r.inverse_norm;
  const Four kept = 1.0 + 2.0 * r.error * share;
  jacobian[0] = r.inverse_norm * (kept * error_by_rotation.x - share * across_query.x);
  jacobian[1] = r.inverse_norm * (kept * error_by_rotation.y - share * across_query.y);
  jacobian[2] = r.inverse_norm * (kept * error_by_rotation.z - share * across_query.z);
  const Vector by_translation = {
      r.inverse_norm * (kept * error_by_translation.x - share * (across_turned.x + t[0] - along * match.x)),
      r.inverse_norm * (kept * error_by_translation.y - share * (across_turned.y + t[1] - along * match.y)),
      r.inverse_norm * (kept * error_by_translation.z - share * (across_turned.z + t[2] - along * match.z))};
  dot(frame.basis.data(), by_translation, jacobian[3]);
  dot(frame.basis.data() + 3, by_translation, jacobian[4]);
}

FABLOOP_INLINE double sum_of(const Four& lanes) { return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]); }

FABLOOP_INLINE void linearise_into(const double* rows, std::size_t padded, const EpipolarFrame& frame, EpipolarSums& sums) {
  Four hessian[15] = {}, gradient[5] = {}, cost = {};
  for (std::size_t i = 0; i < padded; i += kPairsAtOnce) {
    Rays rays;
    load_rays(rows, padded, i, rays);
    Four weight;
    load(rows + 6 * padded + i, weight);
    Residuals residuals;
    residuals_of(rays, frame, residuals);
    Four jacobian[5];
    jacobian_of(rays, frame, residuals, jacobian);
    const Four weighed_angle = weight * residuals.angle;
    cost += weighed_angle * residuals.angle;
    std::size_t next = 0;
    for (std::size_t r = 0; r < 5; ++r) {
      gradient[r] += weighed_angle * jacobian[r];
      const Four weighed = weight * jacobian[r];
      for (std::size_t c = 0; c <= r; ++c) hessian[next++] += weighed * jacobian[c];
    }
  }
  for (std::size_t i = 0; i < 15; ++i) sums.hessian[i] = sum_of(hessian[i]);
  for (std::size_t i = 0; i < 5; ++i) sums.gradient[i] = sum_of(gradient[i]);
  sums.cost = sum_of(cost);
}

FABLOOP_INLINE void jacobian_into(const double* rows, std::size_t padded, const EpipolarFrame& frame,
                                  std::array<double, 5>* out) {
  for (std::size_t i = 0; i < padded; i += kPairsAtOnce) {
    Rays rays;
    load_rays(rows, padded, i, rays);
    Residuals residuals;
    residuals_of(rays, frame, residuals);
    Four jacobian[5];
    jacobian_of(rays, frame, residuals, jacobian);
    for (std::size_t k = 0; k < kPairsAtOnce; ++k) {
      for (std::size_t r = 0; r < 5; ++r) out[i + k][r] = jacobian[r][k];
    }
  }
}

FABLOOP_INLINE void angles_into(const double* rows, std::size_t padded, const EpipolarFrame& frame, double max_error_rad,
                                double* out) {
  for (std::size_t i = 0; i < padded; i += kPairsAtOnce) {
    Rays rays;
    load_rays(rows, padded, i, rays);
    Residuals residuals;
    residuals_of(rays, frame, residuals);
    Vector turned, normal;
    product(frame.rotation.data(), rays.query, turned);
    cross(turned, rays.match, normal);
    Four squared_sine, cosine, match_along, query_along;
    dot(normal, normal, squared_sine);
    dot(turned, rays.match, cosine);
    dot(frame.translation.data(), rays.match, match_along);
    dot(frame.translation.data(), turned, query_along);
    const Four query_depth = cosine * match_along - query_along;  // as ray_depths()
    const Four match_depth = match_along - cosine * query_along;
    const Four squared_angle = residuals.angle * residuals.angle;
    const Four squared_error = max_error_rad * max_error_rad + Four{};
    const auto in_front = (squared_sine < squared_error) | ((query_depth > 0.0) & (match_depth > 0.0));
    const auto is_kept = in_front | (squared_angle >= squared_error);
    store(is_kept ? residuals.angle : kBehindRad + Four{}, out + i);
  }
}

void linearise_baseline(const double* rows, std::size_t padded, const EpipolarFrame& frame, EpipolarSums& sums) {
  linearise_into(rows, padded, frame, sums);
}

void jacobian_baseline(const double* rows, std::size_t padded, const EpipolarFrame& frame, std::array<double, 5>* out) {
  jacobian_into(rows, padded, frame, out);
}

void angles_baseline(const double* rows, std::size_t padded, const EpipolarFrame& frame, double max_error_rad, double* out) {
  angles_into(rows, padded, frame, max_error_rad, out);
}

#if defined(__x86_64__)
__attribute__((target("avx2,fma"))) void linearise_avx2(const double* rows, std::size_t padded, const EpipolarFrame& frame,
                                                        EpipolarSums& sums) {
  linearise_into(rows, padded, frame, sums);
}

__attribute__((target("avx2,fma"))) void jacobian_avx2(const double* rows, std::size_t padded, const EpipolarFrame& frame,
                                                       std::array<double, 5>* out) {
  jacobian_into(rows, padded, frame, out);
}

__attribute__((target("avx2,fma"))) void angles_avx2(const double* rows, std::size_t padded, const EpipolarFrame& frame,
                                                     double max_error_rad, double* out) {
  angles_into(rows, padded, frame, max_error_rad, out);
}
#endif

struct Kernels {
  decltype(&linearise_baseline) linearise = linearise_baseline;
  decltype(&jacobian_baseline) jacobian = jacobian_baseline;
  decltype(&angles_baseline) angles = angles_baseline;
};

const Kernels& fastest_equations() {
#if defined(__x86_64__)
  static const Kernels kernels = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")
                                     ? Kernels{linearise_avx2, jacobian_avx2, angles_avx2}
                                     : Kernels{};
#else
  static const Kernels kernels;
#endif
  return kernels;
}

}  // namespace

EpipolarEquations::EpipolarEquations(std::size_t num_pairs)
    : size_(num_pairs), padded_((num_pairs + kPairsAtOnce - 1) / kPairsAtOnce * kPairsAtOnce), rows_(7 * padded_, 0.0) {}

void EpipolarEquations::set(std::size_t i, const double* query_ray, const double* match_ray, double weight) {
  for (std::size_t k = 0; k < 3; ++k) {
    rows_[k * padded_ + i] = query_ray[k];
    rows_[(3 + k) * padded_ + i] = match_ray[k];
  }
  rows_[6 * padded_ + i] = weight;
}

EpipolarSums EpipolarEquations::linearise(const EpipolarFrame& frame) const {
  EpipolarSums sums;
  fastest_equations().linearise(rows_.data(), padded_, frame, sums);
  return sums;
}

std::vector<std::array<double, 5>> EpipolarEquations::jacobian(const EpipolarFrame& frame) const {
  std::vector<std::array<double, 5>> out(padded_);
  fastest_equations().jacobian(rows_.data(), padded_, frame, out.data());
  out.resize(size_);
  return out;
}

std::vector<double> EpipolarEquations::angles(const EpipolarFrame& frame, double max_error_rad) const {
  std::vector<double> out(padded_);
  fastest_equations().angles(rows_.data(), padded_, frame, max_error_rad, out.data());
  out.resize(size_);
  return out;
}

}  // namespace fabloop
// NOLINTEND(cppcoreguidelines-pro-bounds-*)
