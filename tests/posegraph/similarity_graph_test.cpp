// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/similarity_graph.h"

#include <gtest/gtest.h>

#include <cmath>

#include "frontend/error.h"
#include "posegraph/evaluation/trajectory_error.h"
#include "posegraph/residuals/similarity_residual.h"
#include "tests/posegraph/numeric_derivatives.h"
#include "tests/posegraph/objectives.h"
#include "tests/posegraph/random_graph.h"

namespace fabloop {
namespace {

using test::RandomPoses;

using test::kObjectives;

/// A solver that stops when the cost no longer falls leaves exact graphs this close to the truth.
constexpr double kSimilaritySolverError = 1e-6;

Similarity random_similarity(RandomPoses& random, double size_m) {
  const Pose pose = random.pose(size_m);
  return {std::exp(0.5 * random.number()), pose.rotation, pose.translation};
}

Matrix7d random_information(RandomPoses& random) {
  Matrix7d root;
  for (double& entry : root.reshaped()) entry = random.number();
  return root * root.transpose() + Matrix7d::Identity();
}

/// A chain with random loops, in which every vertex has units of its own; edges agree with the vertices up to `sigma`.
SimilarityGraph random_similarities(std::size_t num_vertices, std::size_t num_loops, double sigma, std::uint32_t seed) {
  const PoseGraph rigid = test::random_graph(3, num_vertices, num_loops, 0.0, seed);
  RandomPoses random(seed + 100);
  SimilarityGraph graph;
  for (const Vertex& vertex : rigid.vertices) {
    graph.vertices.push_back({vertex.id, random_similarity(random, 5.0), false});
  }
  for (const Edge& edge : rigid.edges) {
    Vector7d noise;
    for (double& entry : noise) entry = sigma * random.number();
    const Similarity from_from_to = graph.vertices[edge.from].world_from_frame.inverse() *
                                    graph.vertices[edge.to].world_from_frame * similarity_from_log(noise);
    graph.edges.push_back({edge.from, edge.to, from_from_to, random_information(random), edge.kind});
  }
  return graph;
}

/// Largest of the logarithms of what leads from the vertices of one graph to those of another.
double largest_difference(const SimilarityGraph& a, const SimilarityGraph& b) {
  double largest = 0.0;
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    largest = std::max(largest, log_of(a.vertices[v].world_from_frame.inverse() * b.vertices[v].world_from_frame).norm());
  }
  return largest;
}

std::vector<double> rotation_block(const Similarity& s) {
  return {s.rotation.x(), s.rotation.y(), s.rotation.z(), s.rotation.w()};
}
std::vector<double> translation_block(const Similarity& s) {
  return {s.translation.x(), s.translation.y(), s.translation.z(), std::log(s.scale)};
}

TEST(SimilarityResidual, DerivativesAreThoseOfDifferences) {
  RandomPoses random(1);
  for (int trial = 0; trial < 20; ++trial) {
    for (const Objective objective : kObjectives) {
      const SimilarityEdge edge{0, 1, random_similarity(random, 2.0), random_information(random), EdgeKind::Loop};
      const Similarity i = random_similarity(random, 2.0);
      const Similarity j = i * edge.from_from_to * Similarity{1.2, random.pose(0.0, 0.3).rotation, 0.3 * random.vector()};
      test::expect_derivatives(residuals::SimilarityResidual(edge, objective),
                               {rotation_block(i), translation_block(i), rotation_block(j), translation_block(j)});
    }
  }
}

TEST(SimilarityGraph, CostsAreTheFormulasOfEachObjective) {
  RandomPoses random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const double angle = 0.2;
    const Eigen::Vector3d axis = random.vector().normalized();
    const Similarity error{1.3, Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), random.vector()};
    SimilarityGraph graph;
    const Similarity world_from_i = random_similarity(random, 5.0);
    const Similarity i_from_j = random_similarity(random, 5.0);
    graph.vertices = {{0, world_from_i, false}, {1, world_from_i * i_from_j * error, false}};
    graph.edges = {{0, 1, i_from_j, random_information(random), EdgeKind::Odometry}};
    Vector7d e;
    e << error.translation, angle * axis, std::log(error.scale);
    const Matrix7d& information = graph.edges[0].information;
    const auto cost = [&](Objective objective) { return evaluate_cost(graph, {.objective = objective}); };
    // Sums of squares of numbers up to a hundred.
    constexpr double kCostRounding = 1e-9;
    EXPECT_NEAR(cost(Objective::RotationVector), e.dot(information * e), kCostRounding);
    e.segment<3>(3) = 2.0 * std::sin(0.5 * angle) * axis;
    EXPECT_NEAR(cost(Objective::Quaternion), e.dot(information * e), kCostRounding);
    const double tau = 3.0 / information.topLeftCorner<3, 3>().inverse().trace();
    const double kappa = 3.0 / (2.0 * information.block<3, 3>(3, 3).inverse().trace());
    const double chordal = tau * error.translation.squaredNorm() + 8.0 * kappa * std::pow(std::sin(0.5 * angle), 2) +
                           information(6, 6) * e(6) * e(6);
    EXPECT_NEAR(cost(Objective::Chordal), chordal, kCostRounding);
  }
}

TEST(SimilarityGraph, CostsDoNotDependOnTheWorld) {
  RandomPoses random(3);
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    SimilarityGraph graph = random_similarities(12, 6, 0.1, seed);
    const double cost = evaluate_cost(graph);
    const Similarity other_from_world = random_similarity(random, 10.0);
    for (SimilarityVertex& vertex : graph.vertices) vertex.world_from_frame = other_from_world * vertex.world_from_frame;
    EXPECT_NEAR(evaluate_cost(graph), cost, 1e-9 * cost);
  }
}

TEST(SimilarityGraph, ExactEdgesLeadToTheTruthFromAnywhere) {
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    const SimilarityGraph truth = random_similarities(30, 15, 0.0, seed);
    SimilarityGraph scattered = truth;
    RandomPoses random(seed);
    for (std::size_t v = 1; v < scattered.vertices.size(); ++v) {
      scattered.vertices[v].world_from_frame = random_similarity(random, 50.0);
    }
    SimilarityGraph chained = scattered;
    chain_along_edges(chained);
    EXPECT_LT(largest_difference(chained, truth), kSimilaritySolverError);
    SimilarityGraph relaxed = scattered;
    initialize_chordal(relaxed);
    EXPECT_LT(largest_difference(relaxed, truth), kSimilaritySolverError);
    for (const Objective objective : kObjectives) {
      SimilarityGraph solved = scattered;
      const OptimizeReport report = optimize(solved, {.objective = objective, .initialization = Initialization::LowestCost});
      EXPECT_NE(report.start, Initialization::AsGiven);
      EXPECT_LT(largest_difference(solved, truth), kSimilaritySolverError);
    }
  }
}

TEST(SimilarityGraph, NoStepFromTheOptimumCostsLess) {
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    SimilarityGraph graph = random_similarities(20, 20, 0.05, seed);
    OptimizeOptions options{.objective = Objective::RotationVector, .initialization = Initialization::Chordal};
    const OptimizeReport report = optimize(graph, options);
    EXPECT_EQ(report.termination, Termination::Converged);
    RandomPoses random(seed);
    for (int trial = 0; trial < 20; ++trial) {
      SimilarityGraph moved = graph;
      for (std::size_t v = 1; v < moved.vertices.size(); ++v) {
        Vector7d step;
        for (double& entry : step) entry = 1e-3 * random.number();
        moved.vertices[v].world_from_frame = moved.vertices[v].world_from_frame * similarity_from_log(step);
      }
      EXPECT_GT(evaluate_cost(moved, options), report.final_cost);
    }
  }
}

/// A monocular camera on a circle of 10 m whose unit of length grows by about 1 % a step, unnoticed by its steps: Strasdat,
/// Montiel & Davison, RSS 2010, figure 1. The loop from the last view to the first shows the scale that it lost.
struct DriftingLoop {
  std::vector<Pose> truth;
  SimilarityGraph graph;
};

DriftingLoop drifting_loop(std::uint32_t seed) {
  constexpr int kViews = 90;
  constexpr double kDrift = 0.01;
  constexpr double kDriftNoise = 0.002;
  constexpr double kNoise = 1e-3;
  RandomPoses random(seed);
  DriftingLoop loop;
  std::vector<Similarity> world_from_view;
  double log_scale = 0.0;
  for (int v = 0; v < kViews; ++v) {
    const double angle = 2.0 * kPi * v / kViews;
    const Pose pose{rotation_from_vector({0.0, 0.0, angle}), {10.0 * std::cos(angle), 10.0 * std::sin(angle), 0.0}};
    loop.truth.push_back(pose);
    world_from_view.push_back({std::exp(log_scale), pose.rotation, pose.translation});
    log_scale += kDrift + kDriftNoise * random.number();
  }
  const auto measured = [&](std::size_t i, std::size_t j, bool knows_scale) {
    Vector7d noise;
    for (double& entry : noise) entry = kNoise * random.number();
    Similarity i_from_j = world_from_view[i].inverse() * world_from_view[j] * similarity_from_log(noise);
    if (!knows_scale) i_from_j.scale = 1.0;
    Matrix7d information = Matrix7d::Identity() / (kNoise * kNoise);
    information(6, 6) = 1.0 / std::pow(knows_scale ? kNoise : kDrift, 2);
    return SimilarityEdge{i, j, i_from_j, information, knows_scale ? EdgeKind::Loop : EdgeKind::Odometry};
  };
  for (std::size_t v = 0; v < world_from_view.size(); ++v) {
    loop.graph.vertices.push_back({static_cast<std::int64_t>(v), similarity_from(loop.truth.front()), false});
    if (v > 0) loop.graph.edges.push_back(measured(v - 1, v, false));
  }
  chain_along_edges(loop.graph);
  loop.graph.edges.push_back(measured(0, world_from_view.size() - 1, true));
  return loop;
}

/// RMSE of positions after alignment with scale [m].
double error_of(const std::vector<Pose>& truth, const auto& vertices) {
  Eigen::Matrix3Xd estimate(3, truth.size());
  Eigen::Matrix3Xd reference(3, truth.size());
  for (std::size_t v = 0; v < truth.size(); ++v) {
    estimate.col(static_cast<Eigen::Index>(v)) = vertices[v].world_from_frame.translation;
    reference.col(static_cast<Eigen::Index>(v)) = truth[v].translation;
  }
  const Similarity aligned = align_points(estimate, reference, Alignment::Sim3).value();
  double sum = 0.0;
  for (Eigen::Index v = 0; v < estimate.cols(); ++v) sum += (aligned * estimate.col(v) - reference.col(v)).squaredNorm();
  return std::sqrt(sum / static_cast<double>(estimate.cols()));
}

TEST(SimilarityGraph, LoopsTakeBackTheDriftOfScale) {
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    const DriftingLoop loop = drifting_loop(seed);
    SimilarityGraph solved = loop.graph;
    EXPECT_EQ(optimize(solved, {.objective = Objective::RotationVector}).termination, Termination::Converged);
    PoseGraph rigid;
    for (const SimilarityVertex& vertex : loop.graph.vertices) {
      rigid.vertices.push_back({vertex.id, pose_of(vertex.world_from_frame), false});
    }
    for (const SimilarityEdge& edge : loop.graph.edges) {
      rigid.edges.push_back(
          {edge.from, edge.to, pose_of(edge.from_from_to), edge.information.topLeftCorner<6, 6>(), edge.kind, true});
    }
    optimize(rigid, {.objective = Objective::RotationVector});
    const double drifted = error_of(loop.truth, loop.graph.vertices);
    const double with_scale = error_of(loop.truth, solved.vertices);
    EXPECT_GT(drifted, 1.0);
    // The noise of 90 steps, a walk of sqrt(90) * 0.002 in scale that the loop halves, comes to some centimetres on 10 m.
    EXPECT_LT(with_scale, 0.1);
    EXPECT_GT(error_of(loop.truth, rigid.vertices), 5.0 * with_scale) << "six degrees of freedom cannot do it";
    const double scale_of_last = solved.vertices.back().world_from_frame.scale;
    EXPECT_NEAR(std::log(scale_of_last), std::log(loop.graph.edges.back().from_from_to.scale), 0.01);
  }
}

TEST(SimilarityGraph, FalseLoopsLoseTheirWeight) {
  for (const RobustLoss loss : {RobustLoss::Cauchy, RobustLoss::GemanMcClure, RobustLoss::DynamicCovarianceScaling}) {
    DriftingLoop loop = drifting_loop(7);
    optimize(loop.graph);
    SimilarityEdge wrong = loop.graph.edges.back();
    wrong.from = 10;
    wrong.to = 50;
    loop.graph.edges.push_back(wrong);
    const OptimizeReport report = optimize(loop.graph, {.objective = Objective::RotationVector, .robust_loss = loss});
    EXPECT_LT(report.edges.back().weight, 1e-2);
    EXPECT_LT(error_of(loop.truth, loop.graph.vertices), 0.3);
  }
}

TEST(SimilarityGraph, FixedVerticesStayAndJoinPiecesOfOtherUnits) {
  SimilarityGraph truth = random_similarities(20, 10, 0.0, 5);
  truth.vertices[4].fixed = truth.vertices[15].fixed = true;
  SimilarityGraph graph = truth;
  // Two pieces, each right in units of its own.
  for (std::size_t v = 5; v < 15; ++v) {
    graph.vertices[v].world_from_frame =
        Similarity{3.0, rotation_from_vector({0.0, 0.0, 1.0}), {1.0, 2.0, 3.0}} * graph.vertices[v].world_from_frame;
  }
  const OptimizeReport report = optimize(graph, {.initialization = Initialization::LowestCost});
  EXPECT_EQ(report.anchors, (std::vector<std::size_t>{4, 15}));
  EXPECT_LT(largest_difference(graph, truth), kSimilaritySolverError);
  EXPECT_EQ(graph.vertices[15].world_from_frame.scale, truth.vertices[15].world_from_frame.scale);
}

TEST(SimilarityGraph, OfARigidGraphSolvesAsItDoes) {
  PoseGraph rigid = test::random_graph(3, 20, 10, 0.05, 3);
  // With scale hardly free.
  SimilarityGraph graph = similarity_graph_from(rigid, 1e-5);
  const OptimizeOptions options{.objective = Objective::RotationVector, .initialization = Initialization::Chordal};
  const double cost = optimize(rigid, options).final_cost;
  EXPECT_NEAR(optimize(graph, options).final_cost, cost, 1e-4 * cost);
}

TEST(SimilarityGraph, RefusesWhatIsBroken) {
  const SimilarityGraph good = random_similarities(4, 1, 0.1, 1);
  SimilarityGraph bad = good;
  bad.vertices[2].world_from_frame.scale = 0.0;
  EXPECT_THROW(optimize(bad), InputError);
  bad = good;
  bad.edges[1].from_from_to.scale = -1.0;
  EXPECT_THROW(initialize_chordal(bad), InputError);
  bad = good;
  bad.edges[0].to = 9;
  EXPECT_THROW(evaluate_cost(bad), InputError);
  bad = good;
  bad.edges[0].information(6, 6) = std::nan("");
  EXPECT_THROW(optimize(bad), InputError);
  PoseGraph directed = test::random_graph(3, 4, 1, 0.1, 1);
  directed.edges[2].has_scale = false;
  EXPECT_THROW(similarity_graph_from(directed, 0.01), InputError);
}

}  // namespace
}  // namespace fabloop
