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

/// S = Q - Lambda of Rosen et al., IJRR 2019, at given rotations of d or more rows (private). Q is dense, so it is never formed: it
/// is the Schur complement of the sparse form with translations, in which one translation a component is held.
class CertificateMatrix {
 public:
  /// `stacked`: X, r x (d + 1) n; its translations are set to the best ones.
  CertificateMatrix(const PoseGraph& graph, const Eigen::MatrixXd& stacked);

  /// tr(X M X^T).
  double cost() const { return cost_; }
  /// d n: the number of rows of S, and |Y|_F^2 of any feasible Y.
  Eigen::Index size() const { return num_rotation_rows_; }
  /// Shifts below this are lost in the rounding of the factorisation.
  double rounding() const;
  /// Whether S + shift I is: the signs of D in L D L^T (Sylvester's law of inertia).
  bool is_positive_definite(double shift);

  struct Eigenpair {
    double value = 0.0;
    Eigen::VectorXd vector;  ///< One number per rotation column, d n.
  };
  /// Smallest eigenvalue across the null space spanned by the rows of Y, for a `shift` with S + shift I positive definite: Lanczos
  /// (Spectra) on the inverse of S + shift I. Empty where it does not converge.
  std::optional<Eigenpair> smallest_eigenpair(double shift);

 private:
  void set_best_translations(Eigen::MatrixXd& stacked) const;
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
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace fabloop
