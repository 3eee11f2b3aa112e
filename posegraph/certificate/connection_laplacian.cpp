// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/certificate/connection_laplacian.h"

#include <Eigen/SparseCholesky>
#include <vector>

#include "posegraph/information.h"

namespace fabloop {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

/// kappa |Y_j - Y_i R_ij|_F^2.
void add_rotation(Triplets& entries, Eigen::Index i, Eigen::Index j, double kappa, const Eigen::Matrix3d& i_from_j,
                  int dimension) {
  for (int row = 0; row < dimension; ++row) {
    entries.emplace_back(i + row, i + row, kappa);
    entries.emplace_back(j + row, j + row, kappa);
    for (int column = 0; column < dimension; ++column) {
      entries.emplace_back(i + row, j + column, -kappa * i_from_j(row, column));
      entries.emplace_back(j + column, i + row, -kappa * i_from_j(row, column));
    }
  }
}

/// tau |t_j - t_i - Y_i t_ij|^2: tau a a^T with a = (-1, -t_ij) on the columns of i and 1 on t_j.
void add_translation(Triplets& entries, Eigen::Index i, Eigen::Index j, double tau, const Eigen::Vector3d& t_ij, int dimension) {
  Eigen::Vector4d a;
  a << -1.0, -t_ij;
  for (int row = 0; row <= dimension; ++row) {
    for (int column = 0; column <= dimension; ++column) entries.emplace_back(i + row, i + column, tau * a(row) * a(column));
    entries.emplace_back(i + row, j, tau * a(row));
    entries.emplace_back(j, i + row, tau * a(row));
  }
  entries.emplace_back(j, j, tau);
}

}  // namespace

Eigen::SparseMatrix<double> quadratic_form(const PoseGraph& graph) {
  const int d = graph.dimension;
  Triplets entries;
  entries.reserve(graph.edges.size() * (d == 2 ? 26 : 48));
  for (const Edge& edge : graph.edges) {
    const ChordalWeights weights = chordal_weights(edge, d);
    const Eigen::Index i = column_of(edge.from, d);
    const Eigen::Index j = column_of(edge.to, d);
    add_rotation(entries, i + 1, j + 1, weights.kappa, edge.from_from_to.rotation.toRotationMatrix(), d);
    add_translation(entries, i, j, weights.tau, edge.from_from_to.translation, d);
  }
  const Eigen::Index size = column_of(graph.vertices.size(), d);
  Eigen::SparseMatrix<double> form(size, size);
  form.setFromTriplets(entries.begin(), entries.end());
  return form;
}

Eigen::MatrixXd stacked_poses(const PoseGraph& graph) {
  const int d = graph.dimension;
  Eigen::MatrixXd stacked(d, column_of(graph.vertices.size(), d));
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    const Pose& pose = graph.vertices[v].world_from_frame;
    stacked.col(column_of(v, d)) = pose.translation.head(d);
    stacked.middleCols(column_of(v, d) + 1, d) = pose.rotation.toRotationMatrix().topLeftCorner(d, d);
  }
  return stacked;
}

Eigen::MatrixXd multipliers(const Eigen::SparseMatrix<double>& form, const Eigen::MatrixXd& stacked, int dimension) {
  const Eigen::MatrixXd product = stacked * form;
  const Eigen::Index num_vertices = stacked.cols() / (dimension + 1);
  Eigen::MatrixXd result(num_vertices * dimension, dimension);
  for (Eigen::Index v = 0; v < num_vertices; ++v) {
    const Eigen::Index column = v * (dimension + 1) + 1;
    const Eigen::MatrixXd block = stacked.middleCols(column, dimension).transpose() * product.middleCols(column, dimension);
    result.middleRows(v * dimension, dimension) = 0.5 * (block + block.transpose());
  }
  return result;
}

void set_best_translations(const Eigen::SparseMatrix<double>& form, const std::vector<std::size_t>& component_of_vertex,
                           Eigen::MatrixXd& stacked, int dimension) {
  const auto num_vertices = static_cast<Eigen::Index>(component_of_vertex.size());
  std::vector<bool> is_held(component_of_vertex.size(), false);
  constexpr Eigen::Index kHeld = -1;
  std::vector<Eigen::Index> row(component_of_vertex.size(), kHeld);
  Eigen::Index next = 0;
  for (Eigen::Index v = 0; v < num_vertices; ++v) {
    if (is_held[component_of_vertex[static_cast<std::size_t>(v)]]) row[v] = next++;
    is_held[component_of_vertex[static_cast<std::size_t>(v)]] = true;
  }
  if (next == 0) return;
  // At the best translations the translation columns of X M are zero.
  Eigen::MatrixXd without = stacked;
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index v = 0; v < num_vertices; ++v) {
    const Eigen::Index column = column_of(static_cast<std::size_t>(v), dimension);
    if (row[v] == kHeld) continue;
    without.col(column).setZero();
    for (Eigen::SparseMatrix<double>::InnerIterator it(form, column); it; ++it) {
      const Eigen::Index other = it.row() / (dimension + 1);
      if (it.row() % (dimension + 1) == 0 && row[other] != kHeld) entries.emplace_back(row[v], row[other], it.value());
    }
  }
  Eigen::SparseMatrix<double> laplacian(next, next);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> cholesky(laplacian);
  // Without weights on its translations a graph leaves them open: then they are as good as any.
  if (cholesky.info() != Eigen::Success) return;
  const Eigen::MatrixXd gradient = without * form;
  Eigen::MatrixXd right(next, stacked.rows());
  for (Eigen::Index v = 0; v < num_vertices; ++v) {
    if (row[v] != kHeld) right.row(row[v]) = -gradient.col(column_of(static_cast<std::size_t>(v), dimension)).transpose();
  }
  const Eigen::MatrixXd best = cholesky.solve(right);
  for (Eigen::Index v = 0; v < num_vertices; ++v) {
    if (row[v] != kHeld) stacked.col(column_of(static_cast<std::size_t>(v), dimension)) = best.row(row[v]).transpose();
  }
}

}  // namespace fabloop
