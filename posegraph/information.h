// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "posegraph/pose_graph.h"

namespace fabloop {

/// Isotropic precisions of an edge, for the chordal objective.
struct ChordalWeights {
  double tau = 0.0;    ///< Of the translation [1/m^2]; of the unit direction [1/rad^2] where the edge has no scale.
  double kappa = 0.0;  ///< Of the rotation.
};

/// tau = d / tr(I_t^-1); kappa = 3 / (2 tr(I_r^-1)) in 3-D, I_33 in 2-D (Rosen et al., IJRR 2019, appendix A). Zero where a
/// block is not invertible. Without scale tau is taken over the plane across the direction.
ChordalWeights chordal_weights(const Edge& edge, int dimension);

/// Whether a symmetric matrix has no eigenvalue below zero, rounding apart.
bool is_positive_semidefinite(const Eigen::MatrixXd& symmetric);

/// The nearest positive semi-definite matrix in the Frobenius norm: negative eigenvalues become zero (Higham 1988, theorem 2.1).
Eigen::MatrixXd nearest_positive_semidefinite(const Eigen::MatrixXd& symmetric);

/// W with W^T W = information, so that |W e|^2 = e^T information e. For information = L L^T that is L^T. Negative eigenvalues
/// are taken as zero.
Eigen::MatrixXd whitening(const Eigen::MatrixXd& information);

/// The (x, y, yaw) part of an information matrix, 3 x 3.
Eigen::Matrix3d planar_information(const Matrix6d& information);

/// Two unit vectors across `unit_direction` and across each other, as columns, 3 x 2. Deterministic.
Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& unit_direction);

}  // namespace fabloop
