// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/manifold.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace fabloop::residuals {

/// Rotations (x y z w) that may only turn about the world's z axis: for hosts whose roll and pitch are known from gravity.
class YawManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 4; }
  int TangentSize() const override { return 1; }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Eigen::Quaterniond turn(std::cos(0.5 * delta[0]), 0.0, 0.0, std::sin(0.5 * delta[0]));
    Eigen::Map<Eigen::Quaterniond>{x_plus_delta} = turn * Eigen::Map<const Eigen::Quaterniond>(x);
    return true;
  }
  bool PlusJacobian(const double* x, double* jacobian) const override {
    Eigen::Map<Eigen::Vector4d>{jacobian} << -0.5 * x[1], 0.5 * x[0], 0.5 * x[3], -0.5 * x[2];
    return true;
  }

  /// Never asked for by the solver.
  bool Minus(const double*, const double*, double*) const override { return false; }
  bool MinusJacobian(const double*, double*) const override { return false; }
};

}  // namespace fabloop::residuals
