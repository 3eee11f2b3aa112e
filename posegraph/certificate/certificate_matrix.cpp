// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/certificate/certificate_matrix.h"

#include <Spectra/SymEigsSolver.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "posegraph/certificate/connection_laplacian.h"

namespace fabloop {
namespace {

constexpr Eigen::Index kHeld = -1;

/// v -> (S + shift I)^-1 v, as Spectra asks for it.
class InverseOperator {
 public:
  using Scalar = double;
  InverseOperator(Eigen::Index size, std::function<Eigen::VectorXd(Eigen::VectorXd)> apply)
      : size_(size), apply_(std::move(apply)) {}
  Eigen::Index rows() const { return size_; }
  Eigen::Index cols() const { return size_; }
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Eigen::VectorXd>(out, size_) = apply_(Eigen::Map<const Eigen::VectorXd>(in, size_));
  }

 private:
  Eigen::Index size_;
  std::function<Eigen::VectorXd(Eigen::VectorXd)> apply_;
};

}  // namespace

CertificateMatrix::CertificateMatrix(const PoseGraph& graph, const Eigen::MatrixXd& stacked)
    : dimension_(graph.dimension), components_(connected_components(graph)), form_(quadratic_form(graph)) {
  Eigen::MatrixXd x = stacked;
  set_best_translations(form_, components_.of_vertex, x, dimension_);
  cost_ = (x * form_).cwiseProduct(x).sum();
  set_null_space(x);

  std::vector<bool> is_held(components_.count, false);
  Eigen::Index next = 0;
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    const bool hold = !is_held[components_.of_vertex[v]];
    is_held[components_.of_vertex[v]] = true;
    row_of_column_.push_back(hold ? kHeld : next++);
    for (int k = 0; k < dimension_; ++k) row_of_column_.push_back(next++);
  }
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(form_.nonZeros()));
  const auto add = [&](Eigen::Index row, Eigen::Index column, double value) {
    if (row_of_column_[row] == kHeld || row_of_column_[column] == kHeld || row < column) return;
    entries.emplace_back(row_of_column_[row], row_of_column_[column], value);
  };
  for (Eigen::Index column = 0; column < form_.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(form_, column); it; ++it) add(it.row(), it.col(), it.value());
  }
  const Eigen::MatrixXd lambda = multipliers(form_, x, dimension_);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    const Eigen::Index first = column_of(v, dimension_) + 1;
    for (int row = 0; row < dimension_; ++row) {
      for (int column = 0; column <= row; ++column) {
        add(first + row, first + column, -lambda(static_cast<Eigen::Index>(v) * dimension_ + row, column));
      }
    }
  }
  reduced_.resize(next, next);
  reduced_.setFromTriplets(entries.begin(), entries.end());
}

void CertificateMatrix::set_null_space(const Eigen::MatrixXd& stacked) {
  const auto num_vertices = static_cast<Eigen::Index>(components_.of_vertex.size());
  const Eigen::Index r = stacked.rows();
  num_rotation_rows_ = num_vertices * dimension_;
  null_space_.resize(num_rotation_rows_, r);
  std::vector<Eigen::MatrixXd> gram(components_.count, Eigen::MatrixXd::Zero(r, r));
  for (Eigen::Index v = 0; v < num_vertices; ++v) {
    const Eigen::MatrixXd rotation = stacked.middleCols(column_of(v, dimension_) + 1, dimension_);
    null_space_.middleRows(v * dimension_, dimension_) = rotation.transpose();
    gram[components_.of_vertex[v]] += rotation * rotation.transpose();
  }
  // Y^T (Y Y^T)^(-1/2), without directions that Y does not use.
  constexpr double kRankTolerance = 1e-8;
  for (Eigen::MatrixXd& matrix : gram) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
    const Eigen::VectorXd& values = eigen.eigenvalues();
    const double smallest = kRankTolerance * values.maxCoeff();
    const Eigen::VectorXd inverse_root = values.unaryExpr([&](double e) { return e > smallest ? 1.0 / std::sqrt(e) : 0.0; });
    matrix = eigen.eigenvectors() * inverse_root.asDiagonal();
  }
  for (Eigen::Index v = 0; v < num_vertices; ++v) {
    null_space_.middleRows(v * dimension_, dimension_) *= gram[components_.of_vertex[v]];
  }
}

void CertificateMatrix::project(Eigen::VectorXd& y) const {
  Eigen::MatrixXd share = Eigen::MatrixXd::Zero(null_space_.cols(), static_cast<Eigen::Index>(components_.count));
  const auto component = [&](Eigen::Index row) { return components_.of_vertex[static_cast<std::size_t>(row / dimension_)]; };
  for (Eigen::Index row = 0; row < y.size(); ++row) share.col(component(row)) += y(row) * null_space_.row(row).transpose();
  for (Eigen::Index row = 0; row < y.size(); ++row) y(row) -= null_space_.row(row).dot(share.col(component(row)));
}

double CertificateMatrix::shift_of(double max_relative_gap) const {
  constexpr double kRounding = 1e-14;
  const double largest = reduced_.nonZeros() > 0 ? reduced_.coeffs().cwiseAbs().maxCoeff() : 0.0;
  return std::max(max_relative_gap * cost_ / static_cast<double>(num_rotation_rows_), kRounding * largest);
}

bool CertificateMatrix::is_positive_definite(double shift) {
  if (factored_shift_ == shift) return is_definite_;
  factored_shift_ = shift;
  Eigen::SparseMatrix<double> shifted = reduced_;
  for (std::size_t column = 0; column < row_of_column_.size(); ++column) {
    const bool is_rotation = column % static_cast<std::size_t>(dimension_ + 1) != 0;
    const Eigen::Index row = row_of_column_[column];
    if (is_rotation) shifted.coeffRef(row, row) += shift;
  }
  if (factor_.rows() == 0) factor_.analyzePattern(shifted);
  factor_.factorize(shifted);
  is_definite_ = factor_.info() == Eigen::Success && factor_.vectorD().minCoeff() > 0.0;
  return is_definite_;
}

std::optional<CertificateMatrix::Eigenpair> CertificateMatrix::smallest_eigenpair(double shift) {
  // Gershgorin: beyond the sum of the largest row no shift is needed.
  const double largest = static_cast<double>(dimension_ + 1) * reduced_.coeffs().cwiseAbs().sum();
  constexpr double kStep = 10.0;
  while (!is_positive_definite(shift)) {
    if (!(shift <= largest)) return std::nullopt;
    shift *= kStep;
  }
  // What is held or a translation has a zero on the right: what comes back for rotations is the Schur complement's inverse.
  const auto apply = [&](Eigen::VectorXd y) {
    project(y);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(factor_.rows());
    Eigen::Index next = 0;
    for (std::size_t column = 0; column < row_of_column_.size(); ++column) {
      if (column % static_cast<std::size_t>(dimension_ + 1) != 0) right(row_of_column_[column]) = y(next++);
    }
    const Eigen::VectorXd solution = factor_.solve(right);
    next = 0;
    for (std::size_t column = 0; column < row_of_column_.size(); ++column) {
      if (column % static_cast<std::size_t>(dimension_ + 1) != 0) y(next++) = solution(row_of_column_[column]);
    }
    project(y);
    return y;
  };
  InverseOperator inverse(num_rotation_rows_, apply);
  constexpr Eigen::Index kNumLanczosVectors = 20;
  constexpr Eigen::Index kMaxRestarts = 100;
  constexpr double kTolerance = 1e-6;
  Spectra::SymEigsSolver<InverseOperator> lanczos(inverse, 1, std::min(kNumLanczosVectors, num_rotation_rows_));
  lanczos.init();
  if (lanczos.compute(Spectra::SortRule::LargestAlge, kMaxRestarts, kTolerance) < 1) return std::nullopt;
  return Eigenpair{1.0 / lanczos.eigenvalues()(0) - shift, lanczos.eigenvectors().col(0), shift};
}

}  // namespace fabloop
