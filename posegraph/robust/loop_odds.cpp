// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/loop_odds.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "posegraph/robust/odometry_tree.h"

namespace fabloop {
namespace {

/// Variances of the positions along their principal axes, the largest last.
Eigen::Vector3d spread_of(const std::vector<Vertex>& vertices) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Vertex& vertex : vertices) mean += vertex.world_from_frame.translation;
  mean /= static_cast<double>(std::max<std::size_t>(1, vertices.size()));
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vertex& vertex : vertices) {
    const Eigen::Vector3d x = vertex.world_from_frame.translation - mean;
    covariance += x * x.transpose();
  }
  covariance /= static_cast<double>(std::max<std::size_t>(1, vertices.size()));
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace

std::vector<double> even_odds_chi2(const PoseGraph& graph, double p_false) {
  using std::numbers::pi;
  const bool is_planar = graph.dimension == 2;
  const int num_axes = is_planar ? 2 : 3;
  const int num_angles = is_planar ? 1 : 3;
  const double log_all_rotations = std::log(is_planar ? 2.0 * pi : 8.0 * pi * pi);
  const double prior = 2.0 * std::log((1.0 - p_false) / p_false);
  const Eigen::Vector3d spread = spread_of(graph.vertices);
  std::vector<double> result;
  result.reserve(graph.edges.size());
  for (const Edge& edge : graph.edges) {
    if (!edge.has_scale) {
      result.push_back(0.0);
      continue;
    }
    const Matrix6d covariance = edge_covariance(edge, graph.dimension);
    const double translation = covariance.topLeftCorner<3, 3>().trace() / num_axes;
    const double rotation = covariance.bottomRightCorner<3, 3>().trace() / num_angles;
    double chi2 = prior + 2.0 * log_all_rotations - num_angles * std::log(2.0 * pi * rotation);
    for (int axis = 3 - num_axes; axis < 3; ++axis) chi2 += std::log1p(2.0 * spread(axis) / translation);
    result.push_back(std::max(0.0, chi2));
  }
  return result;
}

}  // namespace fabloop
