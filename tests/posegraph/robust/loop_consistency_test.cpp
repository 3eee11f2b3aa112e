// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/loop_consistency.h"

#include <gtest/gtest.h>

#include <cmath>

#include "posegraph/robust/consistent_loops.h"
#include "posegraph/robust/false_loops.h"
#include "posegraph/robust/loop_clusters.h"
#include "posegraph/robust/sure_path.h"
#include "tests/posegraph/synthetic_graph.h"
#include "verification/uncertain_pose.h"

namespace fabloop {
namespace {

const std::vector<EdgeKind> kLoops = {EdgeKind::Loop};

test::CircleOptions noisy(std::uint32_t seed, int dimension = 3) {
  test::CircleOptions options;
  options.sigma_translation_m = 0.02;
  options.sigma_rotation_rad = 0.005;
  options.seed = seed;
  options.dimension = dimension;
  return options;
}

TEST(OdometryTree, AccumulatesTheNoiseOfTheSteps) {
  // Straight steps of 1 m that only turn by chance: after n steps yaw has n times the variance of a step, and the offset across
  // the sum of the squared distances still to go.
  PoseGraph graph;
  constexpr int kSteps = 6;
  for (int k = 0; k <= kSteps; ++k) graph.vertices.push_back({k, test::shift(k, 0, 0), false});
  for (std::size_t k = 0; k < kSteps; ++k) graph.edges.push_back(test::measured_edge(graph, k, k + 1, EdgeKind::Odometry));
  const double variance = 1e-4;
  for (Edge& edge : graph.edges) {
    edge.information.topLeftCorner<3, 3>() *= 1e4;
    edge.information.bottomRightCorner<3, 3>() /= variance;
  }
  const OdometryTree tree(graph, kLoops);
  ASSERT_TRUE(tree.joins(0, kSteps));
  EXPECT_EQ(tree.num_steps(1, kSteps), std::size_t{kSteps - 1});
  const Matrix6d to_end = adjoint(tree.root_from_vertex(kSteps).inverse());
  const Matrix6d covariance = to_end * tree.covariance_in_root(1, kSteps) * to_end.transpose();
  EXPECT_NEAR(covariance(5, 5), (kSteps - 1) * variance, 1e-12);
  double across = (kSteps - 1) * 1e-4;
  for (int left = 0; left < kSteps - 1; ++left) across += left * left * variance;
  EXPECT_NEAR(covariance(1, 1), across, 1e-12);
}

TEST(LoopConsistency, RightPairsAreRejectedAsOftenAsTheyShould) {
  // Cycles share odometry, so pairs of one graph are not independent: many graphs, and a wide margin.
  for (const int dimension : {2, 3}) {
    std::size_t num_pairs = 0;
    std::size_t num_rejected = 0;
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
      const PoseGraph graph = test::make_circle(noisy(seed, dimension)).graph;
      const LoopConsistency loops(graph, kLoops, 0.9);
      for (std::size_t a = 0; a + 1 < loops.size(); ++a) {
        ++num_pairs;
        num_rejected += !loops.are_consistent(a, a + 1);
      }
    }
    const double share = static_cast<double>(num_rejected) / static_cast<double>(num_pairs);
    EXPECT_NEAR(share, 0.1, 0.04) << dimension << "-D, " << num_pairs << " pairs";
  }
}

TEST(LoopConsistency, DoesNotDependOnTheOrderOrTheDirectionOfLoops) {
  PoseGraph graph = test::make_circle(noisy(3)).graph;
  const LoopConsistency loops(graph, kLoops, 0.99);
  Edge& turned = graph.edges[loops.edges()[1]];
  const Matrix6d information = turned.information;
  const Matrix6d carried = adjoint(turned.from_from_to.inverse());
  turned.information = carried.transpose() * information * carried;
  turned.from_from_to = turned.from_from_to.inverse();
  std::swap(turned.from, turned.to);
  const LoopConsistency with_turned(graph, kLoops, 0.99);
  for (std::size_t b = 2; b < loops.size(); ++b) {
    const double chi2 = loops.chi2(1, b);
    EXPECT_NEAR(with_turned.chi2(1, b), chi2, 1e-6 * (1.0 + chi2));
    // The error stands in another frame, so first-order terms agree and others do not.
    EXPECT_NEAR(loops.chi2(b, 1), chi2, 0.02 * (1.0 + chi2));
  }
}

TEST(LoopConsistency, TellsFalseLoopsFromRightOnes) {
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    PoseGraph graph = test::make_circle(noisy(seed)).graph;
    const std::size_t num_true = LoopConsistency(graph, kLoops, 0.999).size();
    FalseLoopOptions options;
    options.seed = seed;
    add_false_loops(graph, options);
    const LoopConsistency loops(graph, kLoops, 0.999);
    const ConsistentLoops found = most_consistent_loops(loops, 1'000'000'000);
    EXPECT_TRUE(found.is_proven);
    std::size_t num_right = 0;
    for (const std::size_t loop : found.loops) num_right += loop < num_true;
    EXPECT_GE(num_right + 1, num_true) << "seed " << seed;
    EXPECT_LE(found.loops.size(), num_right + 1) << "a false loop may be right by chance";
  }
}

TEST(IncrementalConsistency, FindsTheSameAsAllAtOnce) {
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    PoseGraph whole = test::make_circle(noisy(seed)).graph;
    FalseLoopOptions options;
    options.seed = seed;
    options.share = 0.7;
    add_false_loops(whole, options);
    PoseGraph graph = whole;
    graph.edges.clear();
    IncrementalConsistency incremental;
    std::size_t num_loops = 0;
    for (const Edge& edge : whole.edges) {
      graph.edges.push_back(edge);
      if (edge.kind != EdgeKind::Loop) continue;
      ++num_loops;
      const LoopConsistency loops(graph, kLoops, 0.99);
      EXPECT_EQ(incremental.update(loops).loops.size(), most_consistent_loops(loops, 1'000'000'000).loops.size()) << num_loops;
    }
  }
}

TEST(LoopClusters, HoldLoopsThatAgreeAndLeaveLonersAlone) {
  test::CircleOptions options = noisy(2);
  options.num_vertices = 80;
  PoseGraph graph = test::make_circle(options).graph;
  Edge lone = graph.edges.back();
  lone.from = 3;
  lone.to = 21;
  graph.edges.push_back(lone);
  const LoopConsistency loops(graph, kLoops, 0.999);
  const auto clusters = cluster_loops(loops);
  ASSERT_EQ(clusters.size(), 2u);
  EXPECT_EQ(clusters[0].size(), loops.size() - 1);
  EXPECT_EQ(clusters[1], std::vector<std::size_t>{loops.size() - 1});
  const LoopTrial trial = choose_trial(graph, loops, kLoops);
  EXPECT_TRUE(trial.is_tried.front());
  EXPECT_TRUE(trial.is_foremost.front());
  EXPECT_FALSE(trial.is_tried.back());
}

TEST(SurePaths, ForgetWhatIsRemoved) {
  test::CircleOptions options = noisy(3);
  options.num_vertices = 80;
  const PoseGraph graph = test::make_circle(options).graph;
  const Edge& loop = graph.edges.back();
  ASSERT_EQ(loop.kind, EdgeKind::Loop);
  SurePaths paths(graph, kLoops);
  const UncertainPose around = *paths.find(loop.from, loop.to);
  paths.add(graph.edges.size() - 1);
  const UncertainPose across = *paths.find(loop.from, loop.to);
  EXPECT_LT(across.covariance.trace(), around.covariance.trace());
  paths.remove(graph.edges.size() - 1);
  EXPECT_EQ(paths.find(loop.from, loop.to)->covariance, around.covariance);
}

TEST(ObservedNoiseScale, IsOneForHonestMatricesAndSmallForTimidOnes) {
  test::CircleOptions options = noisy(4);
  options.num_vertices = 300;
  PoseGraph graph = test::make_circle(options).graph;
  EXPECT_EQ(observed_noise_scale(LoopConsistency(graph, kLoops, 0.99)), 1.0);
  for (Edge& edge : graph.edges) edge.information *= 1e-6;
  const double scale = observed_noise_scale(LoopConsistency(graph, kLoops, 0.99));
  EXPECT_LT(scale, 1e-3);
  EXPECT_GT(scale, 1e-6) << "never less than what is shown";
}

}  // namespace
}  // namespace fabloop
