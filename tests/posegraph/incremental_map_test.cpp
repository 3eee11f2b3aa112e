// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/incremental_map.h"

#include <gtest/gtest.h>

#include "frontend/error.h"
#include "posegraph/map_skeleton.h"
#include "posegraph/smooth_correction.h"
#include "tests/posegraph/long_walk.h"
#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

/// Two solvers that stop when the cost no longer falls are this close to one another.
constexpr double kSolverError = 1e-5;

OptimizeOptions to_the_end() {
  OptimizeOptions options;
  options.cost_tolerance = 1e-12;
  return options;
}

test::Circle noisy_circle(std::uint32_t seed) {
  test::CircleOptions options;
  options.num_vertices = 60;
  options.sigma_translation_m = 0.02;
  options.sigma_rotation_rad = 0.005;
  options.seed = seed;
  return test::make_circle(options);
}

/// Feeds the circle vertex by vertex, loops when their later end is there.
IncrementalMap grow(const test::Circle& circle, const IncrementalOptions& options, bool with_neighbours = false) {
  IncrementalMap map(options);
  const std::size_t size = circle.graph.vertices.size();
  for (std::size_t v = 0; v < size; ++v) {
    const Matrix6d information = v == 0 ? Matrix6d::Identity() : circle.graph.edges[v - 1].information;
    map.add_keyframe(circle.graph.vertices[v].id, circle.graph.vertices[v].world_from_frame, information);
    if (with_neighbours && v >= 2) map.add_edge(test::measured_edge(circle.truth, v - 2, v, EdgeKind::Neighbour));
    for (std::size_t e = size - 1; e < circle.graph.edges.size(); ++e) {
      if (circle.graph.edges[e].to == v) map.add_edge(circle.graph.edges[e]);
    }
    map.step();
  }
  return map;
}

TEST(IncrementalMap, FinishesWhereTheBatchDoes) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const test::Circle circle = noisy_circle(seed);
    PoseGraph batch = circle.graph;
    optimize(batch, to_the_end());
    IncrementalMap map = grow(circle, {.optimize = to_the_end()});
    map.finish();
    ASSERT_EQ(map.graph().vertices.size(), batch.vertices.size());
    EXPECT_LT(test::largest_distance(map.graph(), batch), kSolverError);
    EXPECT_LT(test::largest_angle(map.graph(), batch), kSolverError);
  }
}

TEST(IncrementalMap, SettlesStepByStepNearTheBatch) {
  const test::Circle circle = noisy_circle(4);
  PoseGraph batch = circle.graph;
  optimize(batch);
  IncrementalMap map = grow(circle, {});
  for (int k = 0; k < 20 && !map.is_settled(); ++k) EXPECT_EQ(map.step().kind, IncrementalStep::Kind::WholeMap);
  EXPECT_TRUE(map.is_settled());
  EXPECT_LT(test::largest_distance(map.graph(), batch), 0.005) << "a quarter of a step's noise";
  EXPECT_EQ(map.step().kind, IncrementalStep::Kind::Chained);
}

TEST(IncrementalMap, LongMapsMoveInPiecesAndFinishWhereTheBatchDoes) {
  test::LongWalkOptions walk;
  walk.num_poses = 180;
  walk.lap = 60;
  walk.loop_every = 5;
  PoseGraph batch = test::make_long_walk(walk);
  IncrementalOptions options;
  options.max_pieces = 60;
  options.optimize = to_the_end();
  IncrementalMap map(options);
  std::size_t edge = 0;
  for (std::size_t v = 0; v < batch.vertices.size(); ++v) {
    const Matrix6d information = v == 0 ? Matrix6d::Identity() : batch.edges[edge++].information;
    map.add_keyframe(batch.vertices[v].id, batch.vertices[v].world_from_frame, information);
    for (; edge < batch.edges.size() && batch.edges[edge].kind == EdgeKind::Loop; ++edge) map.add_edge(batch.edges[edge]);
    const IncrementalStep step = map.step();
    if (v >= walk.lap && v % walk.loop_every == 0) {
      EXPECT_EQ(step.kind, v < 60 ? IncrementalStep::Kind::WholeMap : IncrementalStep::Kind::Pieces);
    }
  }
  const PoseGraph odometry = batch;
  optimize(batch, to_the_end());
  // Within the walk's noise of the batch, step by step, and there in the end.
  EXPECT_LT(test::largest_distance(map.graph(), batch), 0.2 * test::largest_distance(odometry, batch));
  map.finish();
  EXPECT_LT(test::largest_distance(map.graph(), batch), kSolverError);
}

TEST(MapSkeleton, OfATrueMapMovesNothing) {
  test::LongWalkOptions walk;
  walk.num_poses = 100;
  walk.lap = 40;
  PoseGraph graph = test::make_long_walk(walk);
  optimize(graph);
  const PoseGraph before = graph;
  MapSkeleton skeleton = make_skeleton(graph, 20);
  EXPECT_LE(skeleton.kept.size(), 21u);
  EXPECT_EQ(skeleton.kept.front(), 0u);
  EXPECT_EQ(skeleton.kept.back(), 99u);
  follow_skeleton(skeleton, graph);
  EXPECT_LT(test::largest_distance(graph, before), 1e-9);
  // A shift of the whole skeleton takes every vertex along.
  for (Vertex& vertex : skeleton.graph.vertices) vertex.world_from_frame.translation.x() += 3.0;
  follow_skeleton(skeleton, graph);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    EXPECT_NEAR(graph.vertices[v].world_from_frame.translation.x(), before.vertices[v].world_from_frame.translation.x() + 3.0,
                1e-9);
  }
}

TEST(IncrementalMap, NeighboursMoveTheWindowAndNothingElse) {
  test::Circle circle = noisy_circle(5);
  circle.graph.edges.resize(circle.graph.vertices.size() - 1);
  IncrementalOptions options;
  options.window = 10;
  IncrementalMap map = grow(circle, options, true);
  const PoseGraph before = map.graph();
  const std::size_t newest = before.vertices.size() - 1;
  Edge edge = test::measured_edge(circle.truth, newest - 3, newest, EdgeKind::Neighbour);
  edge.information *= 1e4;
  map.add_edge(edge);
  EXPECT_EQ(map.step().kind, IncrementalStep::Kind::Window);
  for (std::size_t v = 0; v + options.window <= newest; ++v) {
    EXPECT_EQ(map.graph().vertices[v].world_from_frame.translation, before.vertices[v].world_from_frame.translation) << v;
  }
  EXPECT_NE(map.graph().vertices[newest].world_from_frame.translation, before.vertices[newest].world_from_frame.translation);
}

TEST(IncrementalMap, TheCorrectionTakesOdometryToTheMap) {
  const test::Circle circle = noisy_circle(6);
  const IncrementalMap map = grow(circle, {});
  const Pose in_map = map.map_from_odom() * circle.graph.vertices.back().world_from_frame;
  EXPECT_LT((in_map.translation - map.graph().vertices.back().world_from_frame.translation).norm(), 1e-9);
  EXPECT_GT(map.map_from_odom().translation.norm(), 0.0);
  EXPECT_EQ(IncrementalMap().map_from_odom().translation, Eigen::Vector3d::Zero().eval());
}

TEST(IncrementalMap, RefusesWhatCannotBeAnEdge) {
  IncrementalMap map;
  map.add_keyframe(0, {}, Matrix6d::Identity());
  map.add_keyframe(1, test::shift(1, 0, 0), Matrix6d::Identity());
  Edge edge;
  edge.to = 2;
  EXPECT_THROW(map.add_edge(edge), InputError);
  edge.to = 0;
  EXPECT_THROW(map.add_edge(edge), InputError);
  edge.to = 1;
  edge.information(0, 0) = std::nan("");
  EXPECT_THROW(map.add_edge(edge), InputError);
  EXPECT_THROW(map.add_keyframe(2, test::shift(std::nan(""), 0, 0), Matrix6d::Identity()), InputError);
  EXPECT_EQ(map.graph().edges.size(), 1u);
}

TEST(SmoothCorrection, NeverMovesTheBodyFasterThanItMay) {
  const CorrectionLimits limits{0.3, 0.1};
  SmoothCorrection smooth(limits);
  const Pose target{test::rotation_from_vector({0.1, -0.2, 0.8}), {5.0, -2.0, 1.0}};
  // Far from the odometry's origin, where a small turn of the frame is a large move.
  Pose odom_from_body = test::shift(1000, 500, 0);
  constexpr double kStep = 0.1;
  int num_steps = 0;
  for (; num_steps < 100'000; ++num_steps) {
    const Pose before = smooth.map_from_odom() * odom_from_body;
    const Pose after = smooth.update(target, odom_from_body, kStep) * odom_from_body;
    const Pose moved = before.inverse() * after;
    EXPECT_LE(moved.translation.norm(), limits.speed_m_s * kStep + 1e-9);
    EXPECT_LE(rotation_angle(moved.rotation), limits.turn_rate_rad_s * kStep + 1e-9);
    if (smooth.map_from_odom().translation == target.translation) break;
    odom_from_body = odom_from_body * test::shift(0.01, 0, 0);
  }
  EXPECT_EQ(smooth.map_from_odom().rotation.coeffs(), target.rotation.coeffs()) << "after " << num_steps << " steps";
  EXPECT_GT(num_steps, 10);
}

TEST(SmoothCorrection, RefusesTimesThatRunBackwards) {
  SmoothCorrection smooth;
  EXPECT_THROW(smooth.update({}, {}, -1.0), InputError);
  EXPECT_THROW(smooth.update({}, {}, std::nan("")), InputError);
}

}  // namespace
}  // namespace fabloop
