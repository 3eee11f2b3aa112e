// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/information.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace fabloop {
namespace {

/// Files print 6 digits or more, so a zero eigenvalue comes back as one this small beside the largest.
constexpr double kEigenvalueRounding = 1e-9;

/// Up to 3 x 3, without memory of its own: every solve asks for two an edge.
using InformationBlock = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;

/// tr(block^-1), or 0 where there is no inverse.
double trace_of_inverse(const InformationBlock& block) {
  const Eigen::FullPivLU<InformationBlock> lu(block);
  return lu.isInvertible() ? lu.inverse().trace() : 0.0;
}

}  // namespace

ChordalWeights chordal_weights(const Edge& edge, int dimension) {
  const InformationBlock rotation = dimension == 2 ? InformationBlock(edge.information.block<1, 1>(5, 5))
                                                   : InformationBlock(edge.information.block<3, 3>(3, 3));
  InformationBlock translation = edge.information.topLeftCorner(dimension, dimension);
  if (!edge.has_scale) {
    const Eigen::Matrix<double, 3, 2> basis =
        tangent_basis(edge.from_from_to.rotation.conjugate() * edge.from_from_to.translation.normalized());
    translation = basis.transpose() * edge.information.topLeftCorner<3, 3>() * basis;
  }
  const double translation_trace = trace_of_inverse(translation);
  const double rotation_trace = trace_of_inverse(rotation);
  ChordalWeights weights;
  if (translation_trace > 0.0) weights.tau = static_cast<double>(translation.rows()) / translation_trace;
  if (dimension == 2) {
    weights.kappa = std::max(0.0, rotation(0, 0));
  } else if (rotation_trace > 0.0) {
    weights.kappa = 3.0 / (2.0 * rotation_trace);
  }
  return weights;
}

bool is_positive_semidefinite(const Eigen::MatrixXd& symmetric) {
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
  return eigenvalues.minCoeff() >= -kEigenvalueRounding * eigenvalues.cwiseAbs().maxCoeff();
}

Eigen::MatrixXd nearest_positive_semidefinite(const Eigen::MatrixXd& symmetric) {
  const Eigen::MatrixXd w = whitening(symmetric);
  return w.transpose() * w;
}

Eigen::MatrixXd whitening(const Eigen::MatrixXd& information) {
  const Eigen::LLT<Eigen::MatrixXd> cholesky(information);
  if (cholesky.info() == Eigen::Success) return cholesky.matrixU();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
}

Eigen::Matrix3d planar_information(const Matrix6d& information) {
  constexpr std::array<int, 3> kRows = {0, 1, 5};
  Eigen::Matrix3d planar;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) planar(row, column) = information(kRows[row], kRows[column]);
  }
  return planar;
}

Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& unit_direction) {
  Eigen::Index smallest = 0;
  unit_direction.cwiseAbs().minCoeff(&smallest);
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = unit_direction.cross(Eigen::Vector3d::Unit(smallest)).normalized();
  basis.col(1) = unit_direction.cross(basis.col(0));
  return basis;
}

}  // namespace fabloop
