// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <vector>

#include "posegraph/pose_graph.h"

/// The chordal objective as one quadratic form (private).
namespace fabloop {

/// Column of vertex v's translation in X; its rotation's d columns follow.
inline Eigen::Index column_of(std::size_t vertex, int dimension) { return static_cast<Eigen::Index>(vertex) * (dimension + 1); }

/// M, (d + 1) n square, with cost = tr(X M X^T) for X = [t_1 R_1 t_2 R_2 ...], r x (d + 1) n, for any number r >= d of rows.
/// Source: Rosen et al., IJRR 2019, problem 3 and eq. 14-17, the columns sorted by vertex. Both triangles are stored.
Eigen::SparseMatrix<double> quadratic_form(const PoseGraph& graph);

/// X of the poses as they stand, d x (d + 1) n.
Eigen::MatrixXd stacked_poses(const PoseGraph& graph);

/// Sets the translations of X to those of lowest cost for its rotations; the first of each component stays.
void set_best_translations(const Eigen::SparseMatrix<double>& form, const std::vector<std::size_t>& component_of_vertex,
                           Eigen::MatrixXd& stacked, int dimension);

/// Lagrange multipliers of the orthogonality of each rotation: Lambda_i = sym(Y_i^T (X M)_i), d x d, one below the other (Rosen
/// et al., IJRR 2019, eq. 107).
Eigen::MatrixXd multipliers(const Eigen::SparseMatrix<double>& form, const Eigen::MatrixXd& stacked, int dimension);

}  // namespace fabloop
