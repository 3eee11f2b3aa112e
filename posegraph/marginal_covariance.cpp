// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/marginal_covariance.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "frontend/error.h"
#include "posegraph/connectivity.h"
#include "posegraph/residuals/graph_costs.h"
#include "posegraph/solver_state.h"

namespace fabloop {
namespace {

constexpr std::size_t kHeldVertex = std::numeric_limits<std::size_t>::max();

using SparseMatrix = Eigen::SparseMatrix<double>;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Change of a quaternion (x y z w) with a small rotation vector on its right: q * (e / 2, 1).
Eigen::Matrix<double, 4, 3> quaternion_from_error(const Eigen::Quaterniond& q) {
  Eigen::Matrix<double, 4, 3> result;
  result.topRows<3>() = 0.5 * (q.w() * Eigen::Matrix3d::Identity() + cross_matrix(q.vec()));
  result.bottomRows<1>() = -0.5 * q.vec().transpose();
  return result;
}

/// Jacobians of an edge's residual by the errors of its two ends: (translation, rotation) in their own frames, or (x, y, yaw).
std::array<Eigen::MatrixXd, 2> jacobians_of(const PoseGraph& graph, std::size_t e, const GraphCosts& costs,
                                            std::vector<State>& states) {
  const Edge& edge = graph.edges[e];
  const ceres::CostFunction& residual = *costs.edge_residuals()[e];
  std::vector<RowMatrix> by_block;
  for (const int size : residual.parameter_block_sizes()) by_block.emplace_back(residual.num_residuals(), size);
  std::vector<double*> outputs;
  for (RowMatrix& block : by_block) outputs.push_back(block.data());
  Eigen::VectorXd error(residual.num_residuals());
  residual.Evaluate(blocks_of(edge, graph.dimension, states).data(), error.data(), outputs.data());
  const std::array<const Pose*, 2> poses = {&graph.vertices[edge.from].world_from_frame,
                                            &graph.vertices[edge.to].world_from_frame};
  std::array<Eigen::MatrixXd, 2> result;
  for (std::size_t end = 0; end < 2; ++end) {
    const Eigen::Matrix3d rotation = poses[end]->rotation.toRotationMatrix();
    if (graph.dimension == 2) {
      result[end] = by_block[end];
      result[end].leftCols<2>() = by_block[end].leftCols<2>() * rotation.topLeftCorner<2, 2>();
    } else {
      result[end].resize(error.size(), 6);
      result[end].leftCols<3>() = by_block[2 * end + 1] * rotation;
      result[end].rightCols<3>() = by_block[2 * end] * quaternion_from_error(poses[end]->rotation);
    }
  }
  return result;
}

/// Gauss-Newton's information matrix over the vertices that are free; `column` is where each begins.
SparseMatrix information_of(const PoseGraph& graph, const std::vector<std::size_t>& column, Eigen::Index size,
                            const OptimizeOptions& options) {
  const GraphCosts costs(graph, options);
  std::vector<State> states = read_states(graph);
  const std::vector<EdgeResult> results = costs.evaluate_edges(states);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const Edge& edge = graph.edges[e];
    const std::array<Eigen::MatrixXd, 2> by_end = jacobians_of(graph, e, costs, states);
    const std::array<std::size_t, 2> columns = {column[edge.from], column[edge.to]};
    for (std::size_t a = 0; a < 2; ++a) {
      for (std::size_t b = 0; b < 2; ++b) {
        if (columns[a] == kHeldVertex || columns[b] == kHeldVertex) continue;
        const Eigen::MatrixXd block = results[e].weight * by_end[a].transpose() * by_end[b];
        for (Eigen::Index row = 0; row < block.rows(); ++row) {
          for (Eigen::Index col = 0; col < block.cols(); ++col) {
            entries.emplace_back(static_cast<int>(columns[a]) + static_cast<int>(row),
                                 static_cast<int>(columns[b]) + static_cast<int>(col), block(row, col));
          }
        }
      }
    }
  }
  SparseMatrix information(size, size);
  information.setFromTriplets(entries.begin(), entries.end());
  return information;
}

}  // namespace

Eigen::MatrixXd marginal_covariance(const PoseGraph& graph, const std::vector<std::size_t>& vertices,
                                    const OptimizeOptions& options) {
  if (!graph.priors.empty())
    throw InputError("marginal covariances: the graph has priors, which are not counted; give one without");
  check(graph);
  for (const std::size_t v : vertices) {
    if (v >= graph.vertices.size())
      throw InputError("marginal covariance: there is no vertex " + std::to_string(v) + " (from 0)");
  }
  const Eigen::Index width = graph.dimension == 2 ? 3 : 6;
  const std::vector<std::size_t> anchors = find_anchors(graph, connected_components(graph));
  std::vector<std::size_t> column(graph.vertices.size());
  Eigen::Index size = 0;
  for (std::size_t v = 0; v < column.size(); ++v) {
    const bool is_held = std::binary_search(anchors.begin(), anchors.end(), v);
    column[v] = is_held ? kHeldVertex : static_cast<std::size_t>(size);
    if (!is_held) size += width;
  }
  const auto num_asked = static_cast<Eigen::Index>(vertices.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(6 * num_asked, 6 * num_asked);
  if (size == 0) return result;
  const SparseMatrix information = information_of(graph, column, size, options);
  const Eigen::SimplicialLDLT<SparseMatrix> cholesky(information);
  constexpr double kSingular = 1e-14;
  if (cholesky.info() != Eigen::Success || !(cholesky.vectorD().minCoeff() > kSingular * cholesky.vectorD().maxCoeff())) {
    throw InputError("marginal covariance: the edges do not determine the poses; fix a vertex of each part without scale");
  }
  constexpr std::array<Eigen::Index, 6> kSpatial = {0, 1, 2, 3, 4, 5};
  constexpr std::array<Eigen::Index, 3> kPlanar = {0, 1, 5};
  const Eigen::Index* const place = graph.dimension == 2 ? kPlanar.data() : kSpatial.data();
  for (Eigen::Index b = 0; b < num_asked; ++b) {
    const std::size_t column_b = column[vertices[static_cast<std::size_t>(b)]];
    if (column_b == kHeldVertex) continue;
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(size, width);
    unit.middleRows(static_cast<Eigen::Index>(column_b), width).setIdentity();
    const Eigen::MatrixXd columns = cholesky.solve(unit);
    for (Eigen::Index a = 0; a < num_asked; ++a) {
      const std::size_t column_a = column[vertices[static_cast<std::size_t>(a)]];
      if (column_a == kHeldVertex) continue;
      for (Eigen::Index row = 0; row < width; ++row) {
        for (Eigen::Index col = 0; col < width; ++col) {
          result(6 * a + place[row], 6 * b + place[col]) = columns(static_cast<Eigen::Index>(column_a) + row, col);
        }
      }
    }
  }
  return result;
}

}  // namespace fabloop
