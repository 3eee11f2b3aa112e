// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <cmath>

#include "posegraph/information.h"
#include "posegraph/pose_graph.h"

namespace fabloop::residuals {

/// The chordal cost of an edge with rotations of r x d: sqrt(kappa) (Y_j - Y_i R_ij) by columns and sqrt(tau) (t_j - t_i - Y_i
/// t_ij), over the blocks (Y_i, t_i, Y_j, t_j). Linear.
class LiftedResidual final : public ceres::CostFunction {
 public:
  LiftedResidual(const Edge& edge, int dimension, int num_rows) : r_(num_rows), d_(dimension) {
    const ChordalWeights weights = chordal_weights(edge, d_);
    set_num_residuals(r_ * (d_ + 1));
    *mutable_parameter_block_sizes() = {r_ * d_, r_, r_ * d_, r_};
    // Columns of (Y_i, t_i) that make a column of the residual.
    by_i_ = Eigen::MatrixXd::Zero(d_ + 1, d_ + 1);
    by_i_.topLeftCorner(d_, d_) = -std::sqrt(weights.kappa) * edge.from_from_to.rotation.toRotationMatrix().topLeftCorner(d_, d_);
    by_i_.topRightCorner(d_, 1) = -std::sqrt(weights.tau) * edge.from_from_to.translation.head(d_);
    by_i_(d_, d_) = -std::sqrt(weights.tau);
    by_j_ = Eigen::VectorXd::Constant(d_ + 1, std::sqrt(weights.kappa));
    by_j_(d_) = std::sqrt(weights.tau);
  }

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override {
    using Matrix = Eigen::Map<const Eigen::MatrixXd>;
    Eigen::MatrixXd i(r_, d_ + 1);
    Eigen::MatrixXd j(r_, d_ + 1);
    i << Matrix(blocks[0], r_, d_), Matrix(blocks[1], r_, 1);
    j << Matrix(blocks[2], r_, d_), Matrix(blocks[3], r_, 1);
    Eigen::Map<Eigen::MatrixXd>(residual, r_, d_ + 1) = i * by_i_ + j * by_j_.asDiagonal();
    if (jacobians == nullptr) return true;
    const Eigen::MatrixXd diagonal = by_j_.asDiagonal();
    fill(jacobians[0], by_i_.topRows(d_));
    fill(jacobians[1], by_i_.bottomRows(1));
    fill(jacobians[2], diagonal.topRows(d_));
    fill(jacobians[3], diagonal.bottomRows(1));
    return true;
  }

 private:
  /// Derivative of B A, by columns, by the r x k block B: A^T (x) I_r.
  void fill(double* jacobian, const Eigen::MatrixXd& a) const {
    if (jacobian == nullptr) return;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> matrix(jacobian, num_residuals(),
                                                                                              a.rows() * r_);
    matrix.setZero();
    for (Eigen::Index k = 0; k < a.rows(); ++k) {
      for (Eigen::Index c = 0; c < a.cols(); ++c) matrix.block(c * r_, k * r_, r_, r_).diagonal().setConstant(a(k, c));
    }
  }

  int r_;
  int d_;
  Eigen::MatrixXd by_i_;
  Eigen::VectorXd by_j_;
};

}  // namespace fabloop::residuals
