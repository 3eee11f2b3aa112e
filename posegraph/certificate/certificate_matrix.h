// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <optional>
#include <vector>

#include "posegraph/connectivity.h"
#include "posegraph/pose_graph.h"

namespace fabloop {

/// S = Q - Lambda of Rosen et al., IJRR 2019, at given rotations of d or more rows (private). Q is dense, so it is never formed:
/// it is the Schur complement of the sparse form with translations, in which one translation a component is held.
class CertificateMatrix {
 public:
  /// `stacked`: X, r x (d + 1) n; its translations are set to the best ones.
  CertificateMatrix(const PoseGraph& graph, const Eigen::MatrixXd& stacked);

  /// tr(X M X^T).
  double cost() const { return cost_; }
  /// d n: the number of rows of S, and |Y|_F^2 of any feasible Y.
  Eigen::Index size() const { return num_rotation_rows_; }
  /// The shift eta under which S + eta I must be positive definite for a gap of at most this part of the cost: that over d n, and
  /// no less than what the factorisation's rounding leaves of a shift.
  double shift_of(double max_relative_gap) const;
  /// Whether S + shift I is: the signs of D in L D L^T (Sylvester's law of inertia).
  bool is_positive_definite(double shift);

  struct Eigenpair {
    double value = 0.0;
    Eigen::VectorXd vector;     ///< One number per rotation column, d n.
    double proved_shift = 0.0;  ///< S + this I has been proved positive definite.
  };
  /// Smallest eigenvalue across the null space spanned by the rows of Y: Lanczos (Spectra) on the inverse of S + shift I, with
  /// the first of `shift`, 10 `shift`, 100 `shift`, ... that makes it positive definite. Empty where none does or Lanczos does
  /// not converge.
  std::optional<Eigenpair> smallest_eigenpair(double shift);

 private:
  void set_null_space(const Eigen::MatrixXd& stacked);
  /// Removes from `y` what lies in the null space, component by component.
  void project(Eigen::VectorXd& y) const;

  int dimension_;
  Components components_;
  std::vector<Eigen::Index> row_of_column_;  ///< Row in the reduced matrix, -1 where held.
  Eigen::Index num_rotation_rows_ = 0;
  Eigen::SparseMatrix<double> form_;
  /// Orthonormal in each component: spans the rows of Y, d n x r.
  Eigen::MatrixXd null_space_;
  Eigen::SparseMatrix<double> reduced_;  ///< Lower triangle of M - Lambda without the held translations.
  double cost_ = 0.0;
  double factored_shift_ = -1.0;
  bool is_definite_ = false;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace fabloop
