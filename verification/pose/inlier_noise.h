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
  double floor = 0;      ///< Accidental ones a radian: as many as there are between one and three thresholds.
  /// Probability of being true, one for each residual: 0 beyond the threshold.
  std::vector<double> p_true;
};

/// Of the normal distribution about zero.
double normal_density(double value, double sigma);

/// Fits a normal distribution on a uniform floor to residuals [rad], best pairs first, by expectation maximisation. The floor's
/// height is what lies between one and three thresholds, where no true residual is. A pair among many true ones is likelier true.
/// `num_parameters` is the number of the model's, which were fitted to the same residuals.
InlierNoise estimate_inlier_noise(std::span<const double> residuals_rad, double max_error_rad, std::size_t num_parameters);

/// Logarithm of the likelihood of residuals [rad] about a model, over that of `floor` accidental ones a radian and nothing else:
/// sum log(1 + n_i N(r_i) / floor) - mean(n_i) with the true ones' normal distribution N, as of a Poisson process whose rate of
/// true pairs, n_i, follows the order of the pairs (the number of true ones everywhere where the order says nothing). A pair more
/// counts for it by how much more likely it is true than accidental, a sharper noise by how much closer the pairs lie.
double log_likelihood_over_floor(std::span<const double> residuals_rad, const InlierNoise& noise, double floor);

}  // namespace fabloop
