// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace fabloop {

/// A relative pose as plain numbers; matrices row by row.
struct EpipolarFrame {
  std::array<double, 9> rotation{};     ///< match_from_query
  std::array<double, 3> translation{};  ///< Likewise; of unit length.
  std::array<double, 9> essential{};    ///< E with match^T E query = 0.
  std::array<double, 6> basis{};        ///< Two unit vectors across the translation, one after the other.
};

/// Gauss-Newton's view of weighed Sampson distances by (rotation in the query frame, direction on its tangent plane).
struct EpipolarSums {
  std::array<double, 15> hessian{};  ///< Lower triangle, row by row, 1/rad^2.
  std::array<double, 5> gradient{};
  double cost = 0;
};

/// Pairs of rays laid out for refining a pose on them: residuals and derivatives of residuals.h, four pairs at once.
class EpipolarEquations {
 public:
  explicit EpipolarEquations(std::size_t num_pairs);

  /// `weight` says how much the pair counts.
  void set(std::size_t i, const double* query_ray, const double* match_ray, double weight = 1.0);
  std::size_t size() const { return size_; }

  EpipolarSums linearise(const EpipolarFrame& frame) const;

  /// The derivatives of the pairs' Sampson distances, not weighed: `size()` rows of five.
  std::vector<std::array<double, 5>> jacobian(const EpipolarFrame& frame) const;

  /// Sampson distances with their signs [rad]; of pairs within `max_error_rad` that see their point behind a camera, pi.
  /// Parallel rays, whose point is as good as infinitely far, count as in front.
  std::vector<double> angles(const EpipolarFrame& frame, double max_error_rad) const;

 private:
  std::size_t size_;
  std::size_t padded_;
  std::vector<double> rows_;  ///< Seven of `padded_`: query x, y, z, match x, y, z, weight. The last pairs may be void.
};

}  // namespace fabloop
