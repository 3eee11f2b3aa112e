// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fabloop {

/// How an edge's squared whitened error s enters the cost: rho(s). All are s for small errors.
enum class RobustLoss {
  None,    ///< rho(s) = s.
  Huber,   ///< Grows with the error beyond the scale; convex, so it adds no local minima.
  Cauchy,  ///< Grows with the logarithm of the error.
  /// Bounded by the scale: an edge that disagrees is ignored in the end. So are right ones where the start is far off: start
  /// from poses that fit.
  GemanMcClure,
  /// Squared within the scale, then weighed by s^2 with s = 2 c^2 / (c^2 + chi2): dynamic covariance scaling (Agarwal et al.,
  /// ICRA 2013, eq. 14 and 15) with its parameter phi as the squared scale. Bounded by 3 c^2.
  DynamicCovarianceScaling,
};

/// rho(s) for s = chi2, with c2 the squared scale at which the loss leaves the parabola.
/// Source: Z. Zhang, Parameter estimation techniques, Image and Vision Computing 1997, table 1 (Geman-McClure scaled by c2).
double robust_cost(RobustLoss loss, double chi2, double c2);

/// d rho / d s in [0, 1]: how much of the edge's information the optimum listens to.
double robust_weight(RobustLoss loss, double chi2, double c2);

/// d^2 rho / d s^2.
double robust_curvature(RobustLoss loss, double chi2, double c2);

}  // namespace fabloop
