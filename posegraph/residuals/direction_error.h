// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "posegraph/information.h"

namespace fabloop::residuals {

/// Below this length [m] a predicted baseline has no direction, and the error fades to zero instead of dividing by it.
inline constexpr double kMinLength = 1e-6;

/// Error of a translation against a measured unit direction d, on the plane across d: 2 sin(angle / 2) long, the chord, so that
/// the opposite direction is worst.
class DirectionError {
 public:
  struct Value {
    Eigen::Vector2d value;
    Eigen::Matrix<double, 2, 3> by_translation;
  };

  explicit DirectionError(const Eigen::Vector3d& unit_direction)
      : direction_(unit_direction), basis_(tangent_basis(unit_direction)) {}

  /// With u = p / |p|: sqrt(2 / (1 + d^T u)) B^T u.
  Value operator()(const Eigen::Vector3d& translation) const {
    constexpr double kMinOnePlusCos = 1e-6;
    const double length = std::max(translation.norm(), kMinLength);
    const Eigen::Vector3d unit = translation / length;
    const double one_plus_cos = std::max(1.0 + direction_.dot(unit), kMinOnePlusCos);
    const double factor = std::sqrt(2.0 / one_plus_cos);
    const Eigen::Vector2d across = basis_.transpose() * unit;
    Eigen::Matrix<double, 2, 3> by_unit = factor * basis_.transpose();
    if (one_plus_cos > kMinOnePlusCos) by_unit -= 0.5 * factor / one_plus_cos * across * direction_.transpose();
    Eigen::Matrix3d unit_by_translation = Eigen::Matrix3d::Identity() / length;
    if (length > kMinLength) unit_by_translation -= unit * unit.transpose() / length;
    return {factor * across, by_unit * unit_by_translation};
  }

  /// Two unit vectors across d, 3 x 2.
  const Eigen::Matrix<double, 3, 2>& basis() const { return basis_; }

 private:
  Eigen::Vector3d direction_;
  Eigen::Matrix<double, 3, 2> basis_;
};

}  // namespace fabloop::residuals
