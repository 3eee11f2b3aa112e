// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/certificate/certificate.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "frontend/error.h"
#include "posegraph/certificate/certificate_matrix.h"
#include "posegraph/certificate/connection_laplacian.h"
#include "posegraph/optimize.h"
#include "tests/posegraph/random_graph.h"

namespace fabloop {
namespace {

using test::random_graph;
using test::scatter;
using test::wound_ring;

/// Eigenvalues of S by dense algebra: the Schur complement over all translations, with a pseudo-inverse.
Eigen::VectorXd dense_eigenvalues(const PoseGraph& graph) {
  const int d = graph.dimension;
  const auto n = static_cast<Eigen::Index>(graph.vertices.size());
  Eigen::MatrixXd m = Eigen::MatrixXd(quadratic_form(graph));
  const Eigen::SparseMatrix<double> form = quadratic_form(graph);
  Eigen::MatrixXd x = stacked_poses(graph);
  set_best_translations(form, std::vector<std::size_t>(graph.vertices.size(), 0), x, d);
  const Eigen::MatrixXd lambda = multipliers(form, x, d);
  std::vector<Eigen::Index> t_columns;
  std::vector<Eigen::Index> r_columns;
  for (Eigen::Index v = 0; v < n; ++v) {
    t_columns.push_back(v * (d + 1));
    for (int k = 0; k < d; ++k) r_columns.push_back(v * (d + 1) + 1 + k);
    m.block(v * (d + 1) + 1, v * (d + 1) + 1, d, d) -= lambda.middleRows(v * d, d);
  }
  const Eigen::MatrixXd tt = m(t_columns, t_columns);
  const Eigen::MatrixXd tr = m(t_columns, r_columns);
  const Eigen::MatrixXd s = m(r_columns, r_columns) - tr.transpose() * tt.completeOrthogonalDecomposition().pseudoInverse() * tr;
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(s).eigenvalues();
}

TEST(Certificate, OptimaOfNoisyGraphsAreCertified) {
  for (const int dimension : {2, 3}) {
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
      PoseGraph graph = random_graph(dimension, 30, 30, 0.1, seed);
      const double cost = optimize(graph).final_cost;
      const Certificate certificate = certify(graph);
      EXPECT_TRUE(certificate.is_global) << certificate.brief();
      EXPECT_LE(certificate.relative_gap(), 2e-6);
      EXPECT_NEAR(certificate.cost, cost, 1e-6 * cost);
      EXPECT_NE(certificate.brief().find("the global optimum"), std::string::npos);
    }
  }
}

TEST(Certificate, SmallestEigenvalueIsThatOfDenseAlgebra) {
  for (const int dimension : {2, 3}) {
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
      PoseGraph graph = random_graph(dimension, 12, 6, 0.1, seed);
      optimize(graph, {.cost_tolerance = 1e-14});
      const Eigen::VectorXd eigenvalues = dense_eigenvalues(graph);
      for (int k = 0; k < dimension; ++k) EXPECT_NEAR(eigenvalues(k), 0.0, 1e-6) << "the null space";
      // Lanczos' tolerance.
      EXPECT_NEAR(certify(graph).smallest_eigenvalue, eigenvalues(dimension), 1e-4 * eigenvalues(dimension));
    }
  }
}

TEST(Certificate, NegativeEigenvaluesAreThoseOfDenseAlgebra) {
  for (const int dimension : {2, 3}) {
    PoseGraph graph = wound_ring(dimension, 12, 0.01, 1);
    optimize(graph, {.cost_tolerance = 1e-14});
    const double smallest = dense_eigenvalues(graph)(0);
    ASSERT_LT(smallest, -1e-3);
    EXPECT_NEAR(certify(graph).smallest_eigenvalue, smallest, -1e-4 * smallest);
  }
}

TEST(Certificate, LocalMinimaAreRefusedAndTheBoundHolds) {
  for (const int dimension : {2, 3}) {
    PoseGraph stuck = wound_ring(dimension, 15, 0.01, 1);
    PoseGraph best = stuck;
    const OptimizeReport report = optimize(stuck);
    const double optimum = optimize(best, {.initialization = Initialization::Chordal}).final_cost;
    ASSERT_GT(report.final_cost, 2.0 * optimum) << "a local minimum";
    const Certificate refused = certify(stuck);
    EXPECT_FALSE(refused.is_global);
    EXPECT_LT(refused.smallest_eigenvalue, 0.0);
    EXPECT_LE(refused.lower_bound, optimum);
    EXPECT_NE(refused.brief().find("not certified"), std::string::npos);
    EXPECT_TRUE(certify(best).is_global);
  }
}

TEST(Certificate, PosesThatAreNoOptimumAreRefused) {
  PoseGraph graph = random_graph(3, 20, 10, 0.1, 1);
  optimize(graph);
  ASSERT_TRUE(certify(graph).is_global);
  graph.vertices[7].world_from_frame.rotation = graph.vertices[7].world_from_frame.rotation * rotation_from_vector({0.1, 0, 0});
  EXPECT_FALSE(certify(graph).is_global);
}

TEST(Certificate, TranslationsNeedNotBeTheBest) {
  PoseGraph graph = random_graph(3, 20, 10, 0.1, 1);
  const double cost = optimize(graph).final_cost;
  for (Vertex& vertex : graph.vertices) vertex.world_from_frame.translation.setZero();
  const Certificate certificate = certify(graph);
  EXPECT_TRUE(certificate.is_global) << certificate.brief();
  EXPECT_NEAR(certificate.cost, cost, 1e-6 * cost);
}

TEST(Certificate, GraphsWithoutNoiseAreCertifiedAtCostZero) {
  const PoseGraph graph = random_graph(3, 20, 10, 0.0, 1);
  const Certificate certificate = certify(graph);
  EXPECT_TRUE(certificate.is_global) << certificate.brief();
  EXPECT_LT(certificate.cost, 1e-20 * 400);
  EXPECT_EQ(certificate.lower_bound, 0.0);
}

TEST(Certificate, ComponentsAreCertifiedTogether) {
  PoseGraph graph = random_graph(3, 20, 10, 0.1, 1);
  const PoseGraph other = random_graph(3, 10, 5, 0.1, 2);
  for (Vertex vertex : other.vertices) graph.vertices.push_back({vertex.id + 100, vertex.world_from_frame, false});
  for (Edge edge : other.edges) {
    edge.from += 20;
    edge.to += 20;
    graph.edges.push_back(edge);
  }
  graph.vertices.push_back({1000, {}, false});
  graph.vertices[3].fixed = true;
  optimize(graph);
  const Certificate certificate = certify(graph);
  EXPECT_TRUE(certificate.is_global) << certificate.brief();
  EXPECT_GE(certificate.smallest_eigenvalue, -1e-9);
}

TEST(Certificate, RefusesWhatItDoesNotCover) {
  PoseGraph graph = random_graph(3, 10, 5, 0.1, 1);
  graph.edges[2].has_scale = false;
  EXPECT_THROW(certify(graph), InputError);
  graph.edges[2].has_scale = true;
  graph.vertices[2].fixed = graph.vertices[7].fixed = true;
  EXPECT_THROW(certify(graph), InputError);
  graph.vertices[7].fixed = false;
  EXPECT_NO_THROW(certify(graph));
  EXPECT_TRUE(certify(PoseGraph{}).is_global);
}

}  // namespace
}  // namespace fabloop
