// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/odometry_tree.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <deque>

#include "posegraph/information.h"
#include "verification/uncertain_pose.h"

namespace fabloop {
namespace {

/// Smallest eigenvalue of an information matrix that is told from zero, as a share of the largest.
constexpr double kSmallestShare = 1e-9;

Eigen::MatrixXd inverse_of_information(const Eigen::MatrixXd& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  const double floor = std::max(kSmallestShare * eigen.eigenvalues().maxCoeff(), kSmallestShare);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(floor).cwiseInverse().asDiagonal() *
         eigen.eigenvectors().transpose();
}

}  // namespace

Matrix6d edge_covariance(const Edge& edge, int dimension) {
  if (dimension == 3) {
    const Eigen::LLT<Matrix6d> cholesky(edge.information);
    if (cholesky.info() == Eigen::Success && cholesky.rcond() > kSmallestShare) return cholesky.solve(Matrix6d::Identity());
    return inverse_of_information(edge.information);
  }
  const Eigen::Matrix3d planar = inverse_of_information(planar_information(edge.information));
  constexpr int kRows[3] = {0, 1, 5};
  Matrix6d covariance = Matrix6d::Zero();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) covariance(kRows[row], kRows[column]) = planar(row, column);
  }
  return covariance;
}

OdometryTree::OdometryTree(const PoseGraph& graph, const std::vector<EdgeKind>& doubted) {
  const std::size_t size = graph.vertices.size();
  std::vector<std::vector<std::size_t>> edges_of(size);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const Edge& edge = graph.edges[e];
    if (!edge.has_scale || std::find(doubted.begin(), doubted.end(), edge.kind) != doubted.end()) continue;
    edges_of[edge.from].push_back(e);
    edges_of[edge.to].push_back(e);
  }
  root_.assign(size, size);
  depth_.assign(size, 0);
  root_from_vertex_.resize(size);
  covariance_in_root_.assign(size, Matrix6d::Zero());
  ancestors_.assign(1, std::vector<std::size_t>(size));
  std::deque<std::size_t> queue;
  for (std::size_t first = 0; first < size; ++first) {
    if (root_[first] != size) continue;
    root_[first] = ancestors_[0][first] = first;
    for (queue.push_back(first); !queue.empty(); queue.pop_front()) {
      const std::size_t v = queue.front();
      for (const std::size_t e : edges_of[v]) {
        const Edge& edge = graph.edges[e];
        const std::size_t other = edge.from == v ? edge.to : edge.from;
        if (root_[other] != size) continue;
        root_[other] = first;
        depth_[other] = depth_[v] + 1;
        ancestors_[0][other] = v;
        root_from_vertex_[other] = root_from_vertex_[v] * (edge.from == v ? edge.from_from_to : edge.from_from_to.inverse());
        // The error stands in the frame of the edge's end, whichever way it is walked.
        const Matrix6d root_from_error = adjoint(root_from_vertex_[edge.to]);
        covariance_in_root_[other] =
            covariance_in_root_[v] + root_from_error * edge_covariance(edge, graph.dimension) * root_from_error.transpose();
        queue.push_back(other);
      }
    }
  }
  const std::size_t deepest = size == 0 ? 0 : *std::max_element(depth_.begin(), depth_.end());
  for (std::size_t reach = 2; reach <= deepest; reach *= 2) {
    const std::vector<std::size_t>& half = ancestors_.back();
    std::vector<std::size_t> next(size);
    for (std::size_t v = 0; v < size; ++v) next[v] = half[half[v]];
    ancestors_.push_back(std::move(next));
  }
}

std::size_t OdometryTree::common_ancestor(std::size_t i, std::size_t j) const {
  assert(joins(i, j));
  if (depth_[i] < depth_[j]) std::swap(i, j);
  for (std::size_t k = 0, up = depth_[i] - depth_[j]; up > 0; up /= 2, ++k) {
    if (up % 2 == 1) i = ancestors_[k][i];
  }
  if (i == j) return i;
  for (std::size_t k = ancestors_.size(); k-- > 0;) {
    if (ancestors_[k][i] == ancestors_[k][j]) continue;
    i = ancestors_[k][i];
    j = ancestors_[k][j];
  }
  return ancestors_[0][i];
}

std::size_t OdometryTree::num_steps(std::size_t i, std::size_t j) const {
  return depth_[i] + depth_[j] - 2 * depth_[common_ancestor(i, j)];
}

Matrix6d OdometryTree::covariance_in_root(std::size_t i, std::size_t j) const {
  return covariance_in_root_[i] + covariance_in_root_[j] - 2.0 * covariance_in_root_[common_ancestor(i, j)];
}

}  // namespace fabloop
