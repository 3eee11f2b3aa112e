// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/session_alignment.h"

#include <gtest/gtest.h>

#include <random>

#include "posegraph/robust/robust_optimize.h"
#include "tests/posegraph/random_graph.h"
#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

constexpr double kSigmaTranslation = 0.02;
constexpr double kSigmaRotation = 0.002;
constexpr std::size_t kSessions = 3;
constexpr std::size_t kViews = 40;

/// Flights over the same circle, each in a frame of its own; `num_loops` join each two, and `num_false` more do so wrongly.
struct Flights {
  std::vector<Pose> truth;
  PoseGraph graph;
  std::size_t num_right = 0;  ///< Edges before the false ones.
};

/// `alternate`: vertices of the flights in turn, not flight after flight.
Flights make_flights(std::uint32_t seed, std::size_t num_loops, std::size_t num_false, bool alternate = false) {
  test::RandomPoses random(seed);
  std::mt19937 pick(seed);
  Flights flights;
  const auto position = [&](std::size_t session, std::size_t view) {
    return alternate ? view * kSessions + session : session * kViews + view;
  };
  flights.truth.resize(kSessions * kViews);
  flights.graph.vertices.resize(kSessions * kViews);
  for (std::size_t session = 0; session < kSessions; ++session) {
    const Pose own_from_world = session == 0 ? Pose{} : random.pose(100.0);
    for (std::size_t view = 0; view < kViews; ++view) {
      const double angle = 2.0 * kPi * static_cast<double>(view) / kViews;
      const std::size_t v = position(session, view);
      flights.truth[v] = Pose{rotation_from_vector({0.0, 0.0, angle}), {10.0 * std::cos(angle), 10.0 * std::sin(angle), 0.0}} *
                         random.pose(0.2, 0.05);
      flights.graph.vertices[v] = {static_cast<std::int64_t>(v), own_from_world * flights.truth[v], false};
    }
  }
  const auto add = [&](std::size_t from, std::size_t to, EdgeKind kind) {
    Edge edge;
    edge.from = from;
    edge.to = to;
    edge.kind = kind;
    edge.from_from_to = flights.truth[from].inverse() * flights.truth[to] * random.pose(kSigmaTranslation, kSigmaRotation);
    edge.information.topLeftCorner<3, 3>() /= kSigmaTranslation * kSigmaTranslation;
    edge.information.bottomRightCorner<3, 3>() /= kSigmaRotation * kSigmaRotation;
    flights.graph.edges.push_back(edge);
  };
  std::uniform_int_distribution<std::size_t> any(0, kViews - 1);
  for (std::size_t session = 0; session < kSessions; ++session) {
    for (std::size_t view = 1; view < kViews; ++view)
      add(position(session, view - 1), position(session, view), EdgeKind::Odometry);
  }
  // The first two see hardly anything of one another: the third joins them.
  for (const auto& [a, b] : {std::pair<std::size_t, std::size_t>{0, 2}, {1, 2}}) {
    for (std::size_t k = 0; k < num_loops; ++k) {
      const std::size_t view = any(pick);
      add(position(a, view), position(b, (view + 1) % kViews), EdgeKind::Loop);
    }
  }
  flights.num_right = flights.graph.edges.size();
  for (const auto& [a, b] : {std::pair<std::size_t, std::size_t>{0, 2}, {1, 2}, {0, 1}}) {
    for (std::size_t k = 0; k < num_false; ++k) {
      add(position(a, any(pick)), position(b, any(pick)), EdgeKind::Loop);
      flights.graph.edges.back().from_from_to = random.pose(5.0);
    }
  }
  return flights;
}

/// Largest distance of a vertex from the truth, after the first vertex has been laid on its own [m].
double error_of(const Flights& flights, const PoseGraph& graph) {
  const Pose truth_from_world = flights.truth.front() * graph.vertices.front().world_from_frame.inverse();
  double largest = 0.0;
  for (std::size_t v = 0; v < flights.truth.size(); ++v) {
    const Pose moved = truth_from_world * graph.vertices[v].world_from_frame;
    largest = std::max(largest, (moved.translation - flights.truth[v].translation).norm());
  }
  return largest;
}

/// Odometry of 40 steps, seen over the lever of a rotation at its begin and of one loop: sqrt(40) * 0.02 m, and 40 * 0.002 rad on
/// up to 20 m; five sigmas of that.
constexpr double kAlignedByOneLoop = 3.0;

/// After the solve over right loops.
constexpr double kSolved = 0.5;

TEST(SessionAlignment, MostLoopsDecideWhereASessionIs) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    for (const bool alternate : {false, true}) {
      // Most of the loops are false, but they do not agree with one another.
      Flights flights = make_flights(seed, 12, 15, alternate);
      const SessionAlignment alignment = align_sessions(flights.graph);
      EXPECT_EQ(alignment.sessions.count, kSessions);
      ASSERT_EQ(alignment.joins.size(), kSessions - 1);
      for (const SessionJoin& join : alignment.joins) {
        EXPECT_LT(join.edge, flights.num_right) << "seed " << seed;
        EXPECT_GE(join.num_agreeing, alternate ? 3u : 8u);
      }
      // The first two through the third.
      EXPECT_EQ(alignment.joins[0].session, 2u);
      EXPECT_EQ(alignment.joins[1].placed_in, 2u);
      EXPECT_LT(error_of(flights, flights.graph), kAlignedByOneLoop) << "seed " << seed;
    }
  }
}

TEST(SessionAlignment, MovesSessionsAsRigidBodies) {
  Flights flights = make_flights(3, 10, 10);
  const PoseGraph before = flights.graph;
  align_sessions(flights.graph);
  for (std::size_t e = 0; e < kSessions * (kViews - 1); ++e) {
    const Edge& edge = before.edges[e];
    const auto step = [&](const PoseGraph& graph) {
      return graph.vertices[edge.from].world_from_frame.inverse() * graph.vertices[edge.to].world_from_frame;
    };
    EXPECT_LT((step(flights.graph).translation - step(before).translation).norm(), 1e-10);
  }
  EXPECT_EQ(flights.graph.vertices[0].world_from_frame.translation, before.vertices[0].world_from_frame.translation);
}

TEST(SessionAlignment, FixedSessionsStayAndLonelyOnesToo) {
  Flights flights = make_flights(4, 10, 0);
  flights.graph.vertices[2 * kViews].fixed = true;
  flights.graph.vertices.push_back({1000, test::shift(7, 8, 9), false});
  const PoseGraph before = flights.graph;
  const SessionAlignment alignment = align_sessions(flights.graph);
  EXPECT_EQ(alignment.joins.size(), 2u);
  for (const std::size_t v : {2 * kViews, 3 * kViews - 1, 3 * kViews}) {
    EXPECT_EQ(flights.graph.vertices[v].world_from_frame.translation, before.vertices[v].world_from_frame.translation);
  }
}

TEST(SessionAlignment, RobustSolvesBeginThere) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const Flights flights = make_flights(seed, 12, 8);
    for (const BackEnd back_end : {BackEnd::GncTruncated, BackEnd::DynamicCovarianceScaling}) {
      PoseGraph graph = flights.graph;
      const RobustReport report = robust_optimize(graph, {.back_end = back_end, .inlier_probability = 0.999});
      EXPECT_LT(error_of(flights, graph), kSolved) << to_string(back_end) << ", seed " << seed;
      for (std::size_t e = flights.num_right; e < graph.edges.size(); ++e) {
        EXPECT_EQ(report.edges[e].verdict, EdgeVerdict::Rejected) << to_string(back_end) << ", seed " << seed << ", edge " << e;
      }
    }
  }
}

TEST(SessionAlignment, IsAStartOfPlainSolves) {
  const Flights flights = make_flights(6, 12, 0);
  PoseGraph graph = flights.graph;
  const OptimizeReport report = optimize(graph, {.initialization = Initialization::Sessions});
  EXPECT_EQ(report.start, Initialization::Sessions);
  EXPECT_LT(error_of(flights, graph), kSolved);
}

}  // namespace
}  // namespace fabloop
