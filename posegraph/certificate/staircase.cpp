// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/certificate/staircase.h"

#include <ceres/problem.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "frontend/error.h"
#include "posegraph/certificate/certificate_matrix.h"
#include "posegraph/certificate/connection_laplacian.h"
#include "posegraph/residuals/lifted_residual.h"
#include "posegraph/residuals/sparse_solver.h"
#include "posegraph/residuals/stiefel_manifold.h"

namespace fabloop {
namespace {

using residuals::LiftedResidual;
using residuals::StiefelManifold;

double cost_of(const Eigen::SparseMatrix<double>& form, const Eigen::MatrixXd& stacked) {
  return (stacked * form).cwiseProduct(stacked).sum();
}

/// Adds a row in which the columns of rotations move along `direction` (d n), by the largest step tried that lowers the cost.
std::optional<Eigen::MatrixXd> step_down(const PoseGraph& graph, const Eigen::SparseMatrix<double>& form,
                                         const Eigen::MatrixXd& stacked, const Eigen::VectorXd& direction) {
  const int d = graph.dimension;
  const Eigen::Index r = stacked.rows() + 1;
  const std::vector<std::size_t> component_of_vertex = connected_components(graph).of_vertex;
  const double cost = cost_of(form, stacked);
  const double largest = direction.cwiseAbs().maxCoeff();
  constexpr double kSmallestStep = 1e-6;
  for (double step = 1.0; step > kSmallestStep; step *= 0.5) {
    Eigen::MatrixXd lifted(r, stacked.cols());
    lifted << stacked, Eigen::RowVectorXd::Zero(stacked.cols());
    for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
      auto rotation = lifted.middleCols(column_of(v, d) + 1, d);
      rotation.row(r - 1) = step / largest * direction.segment(static_cast<Eigen::Index>(v) * d, d).transpose();
      rotation = StiefelManifold::nearest(rotation);
    }
    set_best_translations(form, component_of_vertex, lifted, d);
    if (cost_of(form, lifted) < cost) return lifted;
  }
  return std::nullopt;
}

/// A local minimum over rotations of as many rows as `stacked` has, from there.
void descend(const PoseGraph& graph, const OptimizeOptions& options, Eigen::MatrixXd& stacked) {
  const int d = graph.dimension;
  const int r = static_cast<int>(stacked.rows());
  const auto translation = [&](std::size_t v) { return stacked.col(column_of(v, d)).data(); };
  const auto rotation = [&](std::size_t v) { return stacked.col(column_of(v, d) + 1).data(); };
  StiefelManifold manifold(r, d);
  std::vector<std::unique_ptr<LiftedResidual>> edges;
  ceres::Problem problem(residuals::unowned());
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    problem.AddParameterBlock(rotation(v), r * d, &manifold);
    problem.AddParameterBlock(translation(v), r);
  }
  for (const Edge& edge : graph.edges) {
    edges.push_back(std::make_unique<LiftedResidual>(edge, d, r));
    problem.AddResidualBlock(edges.back().get(), nullptr, rotation(edge.from), translation(edge.from), rotation(edge.to),
                             translation(edge.to));
  }
  for (const std::size_t v : find_anchors(graph, connected_components(graph))) {
    problem.SetParameterBlockConstant(rotation(v));
    problem.SetParameterBlockConstant(translation(v));
  }
  residuals::run(options, Initialization::AsGiven, problem);
}

/// Rotations and translations of d rows from those of more: the best d-dimensional subspace, then the nearest rotations (Rosen et
/// al., IJRR 2019, algorithm 3). Anchors come to lie where they were.
void round_to_poses(const Eigen::MatrixXd& stacked, PoseGraph& graph) {
  const int d = graph.dimension;
  const auto num_vertices = static_cast<Eigen::Index>(graph.vertices.size());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(stacked.rows(), stacked.rows());
  for (Eigen::Index v = 0; v < num_vertices; ++v) {
    const Eigen::MatrixXd rotation = stacked.middleCols(column_of(static_cast<std::size_t>(v), d) + 1, d);
    gram += rotation * rotation.transpose();
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(gram, Eigen::ComputeFullU);
  Eigen::MatrixXd flat = svd.matrixU().leftCols(d).transpose() * stacked;
  Eigen::Index num_mirrored = 0;
  for (Eigen::Index v = 0; v < num_vertices; ++v) {
    num_mirrored += flat.middleCols(column_of(static_cast<std::size_t>(v), d) + 1, d).determinant() < 0.0;
  }
  if (2 * num_mirrored > num_vertices) flat.row(d - 1) *= -1.0;

  std::vector<Pose> poses(graph.vertices.size());
  for (std::size_t v = 0; v < poses.size(); ++v) {
    const Eigen::MatrixXd block = flat.middleCols(column_of(v, d) + 1, d);
    const Eigen::JacobiSVD<Eigen::MatrixXd> block_svd(block, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::MatrixXd u = block_svd.matrixU();
    if ((u * block_svd.matrixV().transpose()).determinant() < 0.0) u.col(d - 1) *= -1.0;
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    rotation.topLeftCorner(d, d) = u * block_svd.matrixV().transpose();
    poses[v].rotation = Eigen::Quaterniond(rotation);
    poses[v].translation.head(d) = flat.col(column_of(v, d));
  }
  const Components components = connected_components(graph);
  std::vector<Pose> world_from_flat(components.count);
  for (const std::size_t v : find_anchors(graph, components)) {
    world_from_flat[components.of_vertex[v]] = graph.vertices[v].world_from_frame * poses[v].inverse();
    poses[v] = {};
  }
  const std::vector<std::size_t> anchors = find_anchors(graph, components);
  for (std::size_t v = 0; v < poses.size(); ++v) {
    if (std::binary_search(anchors.begin(), anchors.end(), v)) continue;
    graph.vertices[v].world_from_frame = world_from_flat[components.of_vertex[v]] * poses[v];
  }
}

/// Climbs until the lifted optimum is certified, and rounds it into `graph`. How many dimensions that took; none where no way
/// down was found.
std::optional<int> climb(PoseGraph& graph, const GlobalOptions& options) {
  const Eigen::SparseMatrix<double> form = quadratic_form(graph);
  Eigen::MatrixXd stacked = stacked_poses(graph);
  for (int extra = 1; extra <= options.max_extra_dimensions; ++extra) {
    CertificateMatrix matrix(graph, stacked);
    const double shift = matrix.shift_of(options.certificate.max_relative_gap);
    const std::optional<CertificateMatrix::Eigenpair> way = matrix.smallest_eigenpair(shift);
    if (!way || way->value >= 0.0) return std::nullopt;
    std::optional<Eigen::MatrixXd> lifted = step_down(graph, form, stacked, way->vector);
    if (!lifted) return std::nullopt;
    stacked = std::move(*lifted);
    descend(graph, options.optimize, stacked);
    CertificateMatrix lifted_matrix(graph, stacked);
    const bool is_optimal = lifted_matrix.is_positive_definite(lifted_matrix.shift_of(options.certificate.max_relative_gap));
    if (is_optimal || extra == options.max_extra_dimensions) {
      round_to_poses(stacked, graph);
      return extra;
    }
  }
  return std::nullopt;
}

}  // namespace

GlobalReport optimize_globally(PoseGraph& graph, const GlobalOptions& options) {
  if (options.optimize.objective != Objective::Chordal) throw InputError("certificate: only the chordal objective has one");
  if (options.optimize.robust_loss != RobustLoss::None) throw InputError("certificate: there is none under a robust loss");
  GlobalReport report;
  report.optimize = optimize(graph, options.optimize);
  report.certificate = certify(graph, options.certificate);
  if (report.certificate.is_global) return report;

  PoseGraph climbed = graph;
  const std::optional<int> extra = climb(climbed, options);
  if (!extra) return report;
  report.num_extra_dimensions = *extra;
  OptimizeOptions polish = options.optimize;
  polish.initialization = Initialization::AsGiven;
  OptimizeReport polished = optimize(climbed, polish);
  if (polished.final_cost >= report.optimize.final_cost) return report;
  polished.initial_cost = report.optimize.initial_cost;
  polished.start = report.optimize.start;
  report.optimize = std::move(polished);
  report.certificate = certify(climbed, options.certificate);
  graph.vertices = std::move(climbed.vertices);
  return report;
}

}  // namespace fabloop
