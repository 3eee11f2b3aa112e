// SPDX-License-Identifier: BSD-3-Clause
#include "verification/evidence.h"

#include <algorithm>
#include <cmath>

namespace fabloop {
namespace {

double log10_binomial(std::size_t n, std::size_t k) {
  const auto log_factorial = [](std::size_t value) { return std::lgamma(static_cast<double>(value) + 1.0); };
  return (log_factorial(n) - log_factorial(k) - log_factorial(n - k)) / std::log(10.0);
}

}  // namespace

double log10_false_alarms(std::size_t num_matches, std::size_t num_inliers, std::size_t sample_size, double p_accident,
                          double models_per_sample) {
  if (num_inliers <= sample_size || num_inliers > num_matches) return 0.0;
  return std::log10(models_per_sample) + std::log10(static_cast<double>(num_matches - sample_size)) +
         log10_binomial(num_matches, num_inliers) + log10_binomial(num_inliers, sample_size) +
         static_cast<double>(num_inliers - sample_size) * std::log10(p_accident);
}

double p_accidental_epipolar_match(const View& view, double max_error_px) {
  const double width_px = view.camera.width / view.features.pixel_size;
  const double height_px = view.camera.height / view.features.pixel_size;
  const double diagonal_px = std::hypot(width_px, height_px);
  const double area_px = width_px * height_px;
  // The Sampson distance shares the error between two images, so that the band in one of them is wider by sqrt(2).
  return std::min(1.0, 2.0 * std::sqrt(2.0) * max_error_px * diagonal_px / area_px);
}

}  // namespace fabloop
