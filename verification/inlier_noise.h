// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace fabloop {

/// What the residuals of a model say about the data: true ones scatter about zero, accidental ones lie anywhere.
struct InlierNoise {
  double sigma_rad = 0;  ///< Standard deviation of the true ones, per residual.
  double num_true = 0;   ///< Expected number of true ones among the inliers.
  /// Probability of being true, one for each residual: 0 beyond the threshold.
  std::vector<double> p_true;
};

/// Fits a normal distribution on a uniform floor to signed residuals [rad] by expectation maximisation. The floor's height is
/// what lies between one and three thresholds, where no true residual is. `num_parameters` is the number of the model's, which
/// were fitted to the same residuals.
InlierNoise estimate_inlier_noise(std::span<const double> residuals_rad, double max_error_rad, std::size_t num_parameters);

}  // namespace fabloop
