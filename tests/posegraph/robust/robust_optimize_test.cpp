// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/robust_optimize.h"

#include <gtest/gtest.h>

#include "frontend/error.h"
#include "posegraph/robust/false_loops.h"
#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

/// Back ends that give false loops no weight at all in the end.
constexpr BackEnd kChoosing[] = {BackEnd::GncTruncated, BackEnd::PairwiseConsistency};

/// A loop that is kept or lost by chance moves the map by no more than its own noise: 0.02 m an axis.
constexpr double kOneLoopMore = 0.035;

test::Circle circle_of(std::uint32_t seed, int dimension = 3) {
  test::CircleOptions options;
  options.num_vertices = 60;
  options.sigma_translation_m = 0.02;
  options.sigma_rotation_rad = 0.005;
  options.seed = seed;
  options.dimension = dimension;
  return test::make_circle(options);
}

RobustOptions with(BackEnd back_end) {
  RobustOptions options;
  options.back_end = back_end;
  // One right loop in a thousand is lost to chance, so that a handful of graphs loses none.
  options.inlier_probability = 0.999;
  return options;
}

PoseGraph without_false(const test::Circle& circle) {
  PoseGraph graph = circle.graph;
  optimize(graph);
  return graph;
}

TEST(RobustOptimize, EveryBackEndFindsTheOptimumWhereAllLoopsAreRight) {
  for (const int dimension : {2, 3}) {
    const test::Circle circle = circle_of(1, dimension);
    const PoseGraph optimum = without_false(circle);
    for (const BackEnd back_end : all_back_ends()) {
      PoseGraph graph = circle.graph;
      const RobustReport report = robust_optimize(graph, with(back_end));
      // Losses that bend within the scale move the optimum by a part of the noise.
      EXPECT_LT(test::largest_distance(graph, optimum), kOneLoopMore) << to_string(back_end) << ", " << dimension << "-D";
      EXPECT_EQ(report.num_rejected, 0u) << to_string(back_end);
    }
  }
}

TEST(RobustOptimize, FalseLoopsDoNoHarmToThoseThatChoose) {
  for (const int dimension : {2, 3}) {
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
      const test::Circle circle = circle_of(seed, dimension);
      const PoseGraph optimum = without_false(circle);
      for (const FalseLoopPattern pattern : {FalseLoopPattern::Random, FalseLoopPattern::Groups}) {
        PoseGraph with_false = optimum;
        const auto added = add_false_loops(with_false, {pattern, 0.5, 3, seed});
        for (const BackEnd back_end : kChoosing) {
          PoseGraph graph = with_false;
          const RobustReport report = robust_optimize(graph, with(back_end));
          EXPECT_LT(test::largest_distance(graph, optimum), kOneLoopMore) << to_string(back_end) << ", seed " << seed;
          for (const std::size_t e : added) {
            if (report.edges[e].verdict == EdgeVerdict::Kept) {
              EXPECT_LT(report.edges[e].chi2, 25.0) << "a false loop may only stay where it is right by chance";
            }
          }
        }
      }
    }
  }
}

TEST(RobustOptimize, MatricesThatPromiseTooLittleLetNoFalseGroupIn) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    test::CircleOptions options;
    options.num_vertices = 240;
    options.sigma_translation_m = 0.02;
    options.sigma_rotation_rad = 0.002;
    options.seed = seed;
    test::Circle circle = test::make_circle(options);
    // Thirty times less than translations hold, a hundred times less than rotations do.
    circle.graph = with_noise(circle.graph, {900.0, 1e4});
    const PoseGraph optimum = without_false(circle);
    PoseGraph graph = optimum;
    const auto added = add_false_loops(graph, {FalseLoopPattern::Groups, 0.4, 8, seed});
    const RobustReport report = robust_optimize(graph, with(BackEnd::GncTruncated));
    EXPECT_LT(test::largest_distance(graph, optimum), kOneLoopMore) << "seed " << seed;
    for (const std::size_t e : added) EXPECT_EQ(report.edges[e].verdict, EdgeVerdict::Rejected) << "seed " << seed;
    EXPECT_LT(report.noise.translation, 0.01);
    EXPECT_LT(report.noise.rotation, 0.001);
  }
}

TEST(RobustOptimize, EveryBackEndButNoneHoldsOutAgainstOneFalseLoop) {
  const test::Circle circle = circle_of(2);
  const PoseGraph optimum = without_false(circle);
  PoseGraph with_false = circle.graph;
  Edge false_loop = circle.truth.edges.back();
  false_loop.from = 2;
  false_loop.to = 17;
  with_false.edges.push_back(false_loop);
  PoseGraph believed = with_false;
  robust_optimize(believed, with(BackEnd::None));
  const double harm_m = test::largest_distance(believed, optimum);
  for (const BackEnd back_end : all_back_ends()) {
    if (back_end == BackEnd::None) continue;
    PoseGraph graph = with_false;
    const RobustReport report = robust_optimize(graph, with(back_end));
    EXPECT_LT(test::largest_distance(graph, optimum), 0.7 * harm_m) << to_string(back_end);
    EXPECT_EQ(report.edges.back().verdict, EdgeVerdict::Rejected) << to_string(back_end);
  }
}

TEST(RobustOptimize, PriorsPlaceTheMapWhateverBecomesOfItsLoops) {
  const test::Circle circle = circle_of(2);
  const Eigen::Vector3d offset_m(5.0, -3.0, 2.0);
  for (const BackEnd back_end :
       {BackEnd::None, BackEnd::DynamicCovarianceScaling, BackEnd::GncTruncated, BackEnd::PairwiseConsistency}) {
    PoseGraph graph = circle.graph;
    for (std::size_t v = 0; v < graph.vertices.size(); v += 10) {
      VertexPrior prior;
      prior.vertex = v;
      prior.kind = PriorKind::Position;
      prior.world_from_frame = circle.truth.vertices[v].world_from_frame;
      prior.world_from_frame.translation += offset_m;
      prior.information *= 1e4;
      graph.priors.push_back(prior);
    }
    robust_optimize(graph, with(back_end));
    const Eigen::Vector3d moved =
        graph.vertices.front().world_from_frame.translation - circle.truth.vertices.front().world_from_frame.translation;
    // A position is known to 0.01 m an axis.
    EXPECT_LT((moved - offset_m).norm(), 0.05) << to_string(back_end);
  }
}

TEST(RobustOptimize, PriorsKeepTheirShareWhereTheNoiseIsObserved) {
  // Errors a tenth of those told, so that the noise scale is far below 1: the optimum must be that of all, priors included.
  const test::Circle circle = circle_of(4);
  PoseGraph graph = circle.graph;
  for (Edge& edge : graph.edges) edge.information /= 100.0;
  for (std::size_t v = 0; v < graph.vertices.size(); v += 10) {
    VertexPrior prior;
    prior.vertex = v;
    prior.kind = PriorKind::Position;
    prior.world_from_frame = circle.truth.vertices[v].world_from_frame;
    prior.world_from_frame.translation.x() += v % 20 == 0 ? 0.05 : -0.05;
    prior.information *= 1e2;
    graph.priors.push_back(prior);
  }
  PoseGraph expected = graph;
  RobustOptions options = with(BackEnd::None);
  options.optimize.cost_tolerance = 1e-12;
  optimize(expected, options.optimize);
  robust_optimize(graph, options);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    const Eigen::Vector3d apart =
        graph.vertices[v].world_from_frame.translation - expected.vertices[v].world_from_frame.translation;
    EXPECT_LT(apart.norm(), 1e-4) << v;
  }
}

TEST(RobustOptimize, SwitchableConstraintsRefusePriors) {
  PoseGraph graph = circle_of(2).graph;
  graph.priors.emplace_back();
  EXPECT_THROW(robust_optimize(graph, with(BackEnd::SwitchableConstraints)), InputError);
}

TEST(RobustOptimize, EveryBackEndTurnsAboutTheVerticalOnly) {
  const test::Circle circle = circle_of(5);
  for (const BackEnd back_end : all_back_ends()) {
    PoseGraph graph = circle.graph;
    RobustOptions options = with(back_end);
    options.optimize.freedom = Freedom::YawAndPosition;
    options.start = RobustStart::AsGiven;
    EXPECT_NO_THROW(robust_optimize(graph, options)) << to_string(back_end);
  }
}

TEST(RobustOptimize, APersonsDecisionsCountAndCanBeTakenBack) {
  const test::Circle circle = circle_of(3);
  PoseGraph graph = circle.graph;
  Edge false_loop = circle.truth.edges.back();
  false_loop.from = 2;
  false_loop.to = 17;
  graph.edges.push_back(false_loop);
  const std::size_t last = graph.edges.size() - 1;
  for (const BackEnd back_end : all_back_ends()) {
    PoseGraph forced = graph;
    RobustOptions options = with(back_end);
    options.accept = {last};
    options.reject = {last - 1};
    const RobustReport report = robust_optimize(forced, options);
    EXPECT_EQ(report.edges[last].verdict, EdgeVerdict::ForcedAccept);
    EXPECT_EQ(report.edges[last].weight, 1.0);
    EXPECT_EQ(report.edges[last - 1].verdict, EdgeVerdict::ForcedReject);
    EXPECT_EQ(report.edges[last - 1].weight, 0.0);
  }
  // Taken back, from the bent map: as if they had never been.
  PoseGraph direct = graph;
  robust_optimize(direct, with(BackEnd::GncTruncated));
  PoseGraph back = graph;
  RobustOptions options = with(BackEnd::GncTruncated);
  options.reject = {last - 1, last - 2};
  options.warm_weights = robust_optimize(back, options).weights();
  options.reject.clear();
  const RobustReport report = robust_optimize(back, options);
  EXPECT_EQ(report.edges[last].verdict, EdgeVerdict::Rejected);
  EXPECT_EQ(report.edges[last - 1].verdict, EdgeVerdict::Kept);
  EXPECT_LT(test::largest_distance(back, direct), 1e-4);
}

TEST(RobustOptimize, OdometryIsNeverRejected) {
  test::Circle circle = circle_of(4);
  circle.graph.edges[10].from_from_to.translation.x() += 1.0;
  for (const BackEnd back_end : all_back_ends()) {
    PoseGraph graph = circle.graph;
    const RobustReport report = robust_optimize(graph, with(back_end));
    EXPECT_EQ(report.edges[10].verdict, EdgeVerdict::Trusted);
    EXPECT_EQ(report.edges[10].weight, 1.0);
  }
}

TEST(RobustOptimize, SwitchesTellWhatTheyDoAndCanBeStopped) {
  test::Circle circle = circle_of(1);
  std::size_t num_told = 0;
  RobustOptions options = with(BackEnd::SwitchableConstraints);
  // Poses as given, so that the solve with switches is the only one.
  options.start = RobustStart::AsGiven;
  options.optimize.progress = [&](std::string_view, std::size_t, std::size_t) { ++num_told; };
  options.optimize.cancelled = [&] { return num_told == 2; };
  const RobustReport report = robust_optimize(circle.graph, options);
  EXPECT_EQ(num_told, 2u);
  EXPECT_EQ(report.last_solve.termination, Termination::Cancelled);
  EXPECT_EQ(report.last_solve.edges.size(), circle.graph.edges.size());
}

TEST(RobustOptimize, TheSameInputGivesTheSameBits) {
  PoseGraph first = circle_of(5).graph;
  add_false_loops(first);
  PoseGraph second = first;
  robust_optimize(first);
  robust_optimize(second);
  for (std::size_t v = 0; v < first.vertices.size(); ++v) {
    EXPECT_EQ(first.vertices[v].world_from_frame.translation, second.vertices[v].world_from_frame.translation);
  }
}

TEST(RobustOptimize, DirectionsWithoutScaleAreJudgedToo) {
  test::Circle circle = circle_of(6);
  for (Edge& edge : circle.graph.edges) {
    if (edge.kind != EdgeKind::Loop) continue;
    edge.has_scale = false;
    // Loops of the circle are short; a direction needs a baseline.
    edge.to = std::min(edge.to + 3, circle.graph.vertices.size() - 1);
    edge.from_from_to =
        circle.truth.vertices[edge.from].world_from_frame.inverse() * circle.truth.vertices[edge.to].world_from_frame;
    edge.from_from_to.translation.normalize();
  }
  Edge& wrong = circle.graph.edges.back();
  wrong.from_from_to.rotation = wrong.from_from_to.rotation * rotation_from_vector({0.0, 0.0, 1.0});
  for (const BackEnd back_end : kChoosing) {
    PoseGraph graph = circle.graph;
    const RobustReport report = robust_optimize(graph, with(back_end));
    EXPECT_EQ(report.edges.back().verdict, EdgeVerdict::Rejected) << to_string(back_end);
    EXPECT_EQ(report.num_rejected, 1u) << to_string(back_end);
  }
}

TEST(RobustOptimize, ForcedEdgesThatMakeNoSenseAreRefused) {
  PoseGraph graph = circle_of(7).graph;
  const std::size_t loop = graph.edges.size() - 1;
  const auto refused = [&](std::vector<std::size_t> accept, std::vector<std::size_t> reject) {
    RobustOptions options;
    options.accept = std::move(accept);
    options.reject = std::move(reject);
    EXPECT_THROW(robust_optimize(graph, options), InputError);
  };
  refused({graph.edges.size()}, {});
  refused({0}, {});
  refused({loop}, {loop});
  RobustOptions options;
  options.warm_weights = {1.0};
  EXPECT_THROW(robust_optimize(graph, options), InputError);
  options = {};
  options.inlier_probability = 1.0;
  EXPECT_THROW(robust_optimize(graph, options), InputError);
}

TEST(BackEnd, NamesReadBack) {
  for (const BackEnd back_end : all_back_ends()) EXPECT_EQ(back_end_named(to_string(back_end)), back_end);
  EXPECT_FALSE(back_end_named("magic"));
}

}  // namespace
}  // namespace fabloop
