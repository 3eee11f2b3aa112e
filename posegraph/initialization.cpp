// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/initialization.h"

#include <Eigen/Core>
#include <Eigen/SVD>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cassert>
#include <optional>
#include <vector>

#include "posegraph/connectivity.h"
#include "posegraph/information.h"

namespace fabloop {
namespace {

/// Part of the largest weight that an edge has at least, so that a vertex joined by edges without information has a place.
constexpr double kMinRelativeWeight = 1e-9;

/// Up to 3 x 3, without memory of its own.
using SmallBlock = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;

/// Least squares over one block of unknown rows for each free vertex: sum of w |Y_j - A Y_i - B|^2.
class BlockSystem {
 public:
  /// `num_rows` of each unknown block, and how many columns.
  BlockSystem(std::size_t num_vertices, const std::vector<std::size_t>& anchors, int num_rows, int num_columns)
      : num_rows_(num_rows), position_(num_vertices, 0) {
    for (const std::size_t anchor : anchors) position_[anchor] = kHeld;
    int next = 0;
    for (int& position : position_) {
      if (position != kHeld) position = next++ * num_rows;
    }
    right_.setZero(next * num_rows, num_columns);
  }

  /// Held blocks are read from `values`, one block of rows a vertex.
  void add(const Edge& edge, double weight, const SmallBlock& a, const SmallBlock& b, const Eigen::MatrixXd& values) {
    const int i = position_[edge.from];
    const int j = position_[edge.to];
    const auto held = [&](std::size_t v) { return values.middleRows(static_cast<Eigen::Index>(v) * num_rows_, num_rows_); };
    if (i != kHeld) add_block(i, i, weight * a.transpose() * a);
    if (j != kHeld) add_block(j, j, weight * SmallBlock::Identity(num_rows_, num_rows_));
    if (i != kHeld && j != kHeld) i > j ? add_block(i, j, -weight * a.transpose()) : add_block(j, i, -weight * a);
    const SmallBlock known_j = j == kHeld ? SmallBlock(held(edge.to) - b) : SmallBlock(-b);
    const SmallBlock known_i = i == kHeld ? SmallBlock(b + a * held(edge.from)) : b;
    if (i != kHeld) right_.middleRows(i, num_rows_) += weight * a.transpose() * known_j;
    if (j != kHeld) right_.middleRows(j, num_rows_) += weight * known_i;
  }

  /// Writes the free blocks of `values`.
  void solve(Eigen::MatrixXd& values) {
    if (right_.rows() == 0) return;
    Eigen::SparseMatrix<double> matrix(right_.rows(), right_.rows());
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> cholesky(matrix);
    // Every free vertex hangs by edges of positive weight on an anchor, so the matrix is positive definite.
    assert(cholesky.info() == Eigen::Success);
    const Eigen::MatrixXd solution = cholesky.solve(right_);
    for (std::size_t v = 0; v < position_.size(); ++v) {
      if (position_[v] == kHeld) continue;
      values.middleRows(static_cast<Eigen::Index>(v) * num_rows_, num_rows_) = solution.middleRows(position_[v], num_rows_);
    }
  }

 private:
  static constexpr int kHeld = -1;

  /// Lower triangle only.
  void add_block(int row, int column, const SmallBlock& block) {
    for (int r = 0; r < num_rows_; ++r) {
      const int last = row == column ? r : num_rows_ - 1;
      for (int c = 0; c <= last; ++c) {
        if (block(r, c) != 0.0) entries_.emplace_back(row + r, column + c, block(r, c));
      }
    }
  }

  int num_rows_;
  std::vector<int> position_;
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::MatrixXd right_;
};

/// The rotation nearest to a matrix in the Frobenius norm (Kabsch 1976).
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0.0) u.col(2) *= -1.0;
  return u * svd.matrixV().transpose();
}

struct Weights {
  std::vector<double> tau;
  std::vector<double> kappa;
};

Weights weights_of(const PoseGraph& graph) {
  Weights weights;
  for (const Edge& edge : graph.edges) {
    const ChordalWeights chordal = chordal_weights(edge, graph.dimension);
    weights.tau.push_back(edge.has_scale ? chordal.tau : 0.0);
    weights.kappa.push_back(chordal.kappa);
  }
  for (std::vector<double>* list : {&weights.tau, &weights.kappa}) {
    const double largest = list->empty() ? 0.0 : *std::max_element(list->begin(), list->end());
    const double smallest = largest > 0.0 ? kMinRelativeWeight * largest : 1.0;
    for (double& weight : *list) weight = std::max(weight, smallest);
  }
  return weights;
}

/// Rows of R_v^T, d of them a vertex: column k of R^T is row k of R, and each obeys R_j^T = R_ij^T R_i^T.
void solve_rotations(PoseGraph& graph, const std::vector<std::size_t>& anchors, const std::vector<double>& kappa) {
  const int d = graph.dimension;
  Eigen::MatrixXd transposed(static_cast<Eigen::Index>(graph.vertices.size()) * d, d);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    transposed.middleRows(static_cast<Eigen::Index>(v) * d, d) =
        graph.vertices[v].world_from_frame.rotation.toRotationMatrix().topLeftCorner(d, d).transpose();
  }
  BlockSystem system(graph.vertices.size(), anchors, d, d);
  const SmallBlock zero = SmallBlock::Zero(d, d);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const SmallBlock j_from_i = graph.edges[e].from_from_to.rotation.toRotationMatrix().topLeftCorner(d, d).transpose();
    system.add(graph.edges[e], kappa[e], j_from_i, zero, transposed);
  }
  system.solve(transposed);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    if (std::binary_search(anchors.begin(), anchors.end(), v)) continue;
    const Eigen::MatrixXd relaxed = transposed.middleRows(static_cast<Eigen::Index>(v) * d, d).transpose();
    Eigen::Quaterniond& rotation = graph.vertices[v].world_from_frame.rotation;
    if (d == 2) {
      const double yaw = std::atan2(relaxed(1, 0) - relaxed(0, 1), relaxed(0, 0) + relaxed(1, 1));
      rotation = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
    } else {
      rotation = Eigen::Quaterniond(nearest_rotation(relaxed));
    }
  }
}

void solve_translations(PoseGraph& graph, const std::vector<std::size_t>& anchors, const std::vector<double>& tau) {
  Eigen::MatrixXd translations(graph.vertices.size(), 3);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    translations.row(static_cast<Eigen::Index>(v)) = graph.vertices[v].world_from_frame.translation.transpose();
  }
  BlockSystem system(graph.vertices.size(), anchors, 1, 3);
  const SmallBlock one = SmallBlock::Ones(1, 1);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const Edge& edge = graph.edges[e];
    const Pose& world_from_i = graph.vertices[edge.from].world_from_frame;
    Eigen::Vector3d t_ij = edge.from_from_to.translation;
    if (!edge.has_scale) {
      const double length = (graph.vertices[edge.to].world_from_frame.translation - world_from_i.translation).norm();
      t_ij = t_ij.normalized() * (length > 0.0 ? length : 1.0);
    }
    system.add(edge, tau[e], one, (world_from_i.rotation * t_ij).transpose(), translations);
  }
  system.solve(translations);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    if (std::binary_search(anchors.begin(), anchors.end(), v)) continue;
    graph.vertices[v].world_from_frame.translation = translations.row(static_cast<Eigen::Index>(v)).transpose();
  }
}

}  // namespace

void initialize_chordal(PoseGraph& graph) {
  check(graph);
  const std::vector<std::size_t> anchors = find_anchors(graph, connected_components(graph));
  const Weights weights = weights_of(graph);
  solve_rotations(graph, anchors, weights.kappa);
  solve_translations(graph, anchors, weights.tau);
}

}  // namespace fabloop
