// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/manifold.h>

#include <Eigen/Core>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace fabloop::residuals {

/// Matrices Y of r x d with orthonormal columns, stored by columns: rotations given r - d dimensions more. Steps are
/// Y + Y Omega + Y_across K (Omega skew, Y_across the rest of a basis), brought back by the nearest such matrix.
/// Source: Absil, Mahony & Sepulchre, Optimization Algorithms on Matrix Manifolds, 2008, examples 3.5.2 and 4.1.3.
class StiefelManifold final : public ceres::Manifold {
 public:
  StiefelManifold(int num_rows, int num_columns) : r_(num_rows), d_(num_columns) {}

  int AmbientSize() const override { return r_ * d_; }
  int TangentSize() const override { return d_ * (d_ - 1) / 2 + (r_ - d_) * d_; }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Eigen::Map<const Eigen::VectorXd> step(delta, TangentSize());
    const Eigen::VectorXd moved = Eigen::Map<const Eigen::VectorXd>(x, AmbientSize()) + basis(x) * step;
    Eigen::Map<Eigen::MatrixXd>(x_plus_delta, r_, d_) = nearest(moved.reshaped(r_, d_));
    return true;
  }

  bool PlusJacobian(const double* x, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(jacobian, AmbientSize(), TangentSize()) =
        basis(x);
    return true;
  }

  /// Never asked for by the solver.
  bool Minus(const double*, const double*, double*) const override { return false; }
  bool MinusJacobian(const double*, double*) const override { return false; }

  /// The matrix with orthonormal columns nearest to `matrix` in the Frobenius norm.
  static Eigen::MatrixXd nearest(const Eigen::MatrixXd& matrix) {
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
    return svd.matrixU() * svd.matrixV().transpose();
  }

 private:
  /// Tangent vectors at x as columns, r d x tangent size.
  Eigen::MatrixXd basis(const double* x) const {
    const Eigen::Map<const Eigen::MatrixXd> y(x, r_, d_);
    const Eigen::MatrixXd full = Eigen::HouseholderQR<Eigen::MatrixXd>(y).householderQ();
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(AmbientSize(), TangentSize());
    Eigen::Index next = 0;
    for (int a = 0; a < d_; ++a) {
      for (int b = a + 1; b < d_; ++b, ++next) {
        result.col(next).segment(a * r_, r_) = -y.col(b);
        result.col(next).segment(b * r_, r_) = y.col(a);
      }
    }
    for (int across = d_; across < r_; ++across) {
      for (int a = 0; a < d_; ++a, ++next) result.col(next).segment(a * r_, r_) = full.col(across);
    }
    return result;
  }

  int r_;
  int d_;
};

}  // namespace fabloop::residuals
