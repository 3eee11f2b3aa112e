// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/g2o/g2o_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/error.h"
#include "posegraph/optimize.h"
#include "tests/posegraph/random_graph.h"
#include "tests/posegraph/scratch_folder.h"
#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

using test::message_of;
using test::ScratchFolder;
using testing::HasSubstr;

constexpr const char* kUnitInformation = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1";

std::string edge(const std::string& ends, const std::string& tag = "EDGE_SE3:QUAT") {
  return tag + " " + ends + " 1 2 3 0 0 0 1" + kUnitInformation + "\n";
}

const std::string kTwoVertices = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 2 3 0 0 0 1\n";

void expect_same_bits(const PoseGraph& a, const PoseGraph& b) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  ASSERT_EQ(a.edges.size(), b.edges.size());
  EXPECT_EQ(a.dimension, b.dimension);
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    EXPECT_EQ(a.vertices[v].id, b.vertices[v].id);
    EXPECT_EQ(a.vertices[v].fixed, b.vertices[v].fixed);
    EXPECT_EQ(a.vertices[v].world_from_frame.translation, b.vertices[v].world_from_frame.translation);
    EXPECT_EQ(a.vertices[v].world_from_frame.rotation.coeffs(), b.vertices[v].world_from_frame.rotation.coeffs());
  }
  for (std::size_t e = 0; e < a.edges.size(); ++e) {
    EXPECT_EQ(a.edges[e].from, b.edges[e].from);
    EXPECT_EQ(a.edges[e].to, b.edges[e].to);
    EXPECT_EQ(a.edges[e].kind, b.edges[e].kind);
    EXPECT_EQ(a.edges[e].has_scale, b.edges[e].has_scale);
    EXPECT_EQ(a.edges[e].information, b.edges[e].information);
    EXPECT_EQ(a.edges[e].from_from_to.translation, b.edges[e].from_from_to.translation);
    EXPECT_EQ(a.edges[e].from_from_to.rotation.coeffs(), b.edges[e].from_from_to.rotation.coeffs());
  }
}

TEST(G2o, RoundTripsToTheSameBits) {
  const ScratchFolder folder;
  test::CircleOptions options;
  options.sigma_translation_m = 0.1;
  options.sigma_rotation_rad = 0.1;
  PoseGraph graph = test::make_circle(options).graph;
  graph.vertices[3].fixed = true;
  graph.vertices[4].id = -17;
  graph.edges[2].kind = EdgeKind::Neighbour;
  graph.edges[5].kind = EdgeKind::Loop;
  graph.edges.back().kind = EdgeKind::Odometry;
  graph.edges.back().has_scale = false;
  graph.edges.back().information(0, 4) = graph.edges.back().information(4, 0) = 1.0 / 3.0;
  write_g2o(folder.path() / "a.g2o", graph);
  expect_same_bits(read_g2o(folder.path() / "a.g2o"), graph);
}

TEST(G2o, PlanarGraphsRoundTrip) {
  const ScratchFolder folder;
  test::CircleOptions options;
  options.dimension = 2;
  options.sigma_translation_m = 0.1;
  options.sigma_rotation_rad = 0.1;
  const PoseGraph graph = test::make_circle(options).graph;
  write_g2o(folder.path() / "a.g2o", graph);
  const PoseGraph read = read_g2o(folder.path() / "a.g2o");
  EXPECT_EQ(read.dimension, 2);
  EXPECT_EQ(test::largest_distance(read, graph), 0.0);
  // The angle is written, the quaternion is kept: the last bits of a half angle differ.
  EXPECT_LT(test::largest_angle(read, graph), 1e-15);
  EXPECT_EQ(read.edges[3].information(0, 0), graph.edges[3].information(0, 0));
  EXPECT_EQ(read.edges[3].information(5, 5), graph.edges[3].information(5, 5));
}

TEST(G2o, ReadsWhatOthersWrite) {
  const ScratchFolder folder;
  const auto path = folder.write("a.g2o", "# a comment\n\n" + kTwoVertices + "VERTEX_SE3:QUAT 7 0 0 0 0 0 0 1\r\nFIX 1\n" +
                                              edge("0 1") + edge("7 1") + edge("1 0", "EDGE_SE3_DIRECTION:QUAT"));
  const PoseGraph graph = read_g2o(path);
  ASSERT_EQ(graph.vertices.size(), 3u);
  EXPECT_EQ(graph.vertices[2].id, 7);
  EXPECT_TRUE(graph.vertices[1].fixed);
  EXPECT_FALSE(graph.vertices[0].fixed);
  ASSERT_EQ(graph.edges.size(), 3u);
  EXPECT_EQ(graph.edges[0].kind, EdgeKind::Odometry);
  EXPECT_EQ(graph.edges[1].from, 2u);
  EXPECT_EQ(graph.edges[1].kind, EdgeKind::Loop);
  EXPECT_FALSE(graph.edges[2].has_scale);
  EXPECT_EQ(graph.edges[0].from_from_to.translation, Eigen::Vector3d(1, 2, 3));
}

TEST(G2o, InformationIsUpperTriangularByRows) {
  const ScratchFolder folder;
  const auto path = folder.write(
      "a.g2o", kTwoVertices + "EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 1 90 1 2 3 4 5 91 6 7 8 9 92 10 11 12 93 13 14 94 15 95\n");
  const Matrix6d information = read_g2o(path).edges[0].information;
  EXPECT_EQ(information(0, 5), 5);
  EXPECT_EQ(information(5, 0), 5);
  EXPECT_EQ(information(1, 2), 6);
  EXPECT_EQ(information(2, 3), 10);
  EXPECT_EQ(information(5, 5), 95);
}

TEST(G2o, WithoutVerticesPosesAreChained) {
  const ScratchFolder folder;
  std::string note;
  G2oOptions options;
  options.warn = [&](const std::string& message) { note += message; };
  const PoseGraph graph = read_g2o(folder.write("a.g2o", edge("5 6") + edge("6 9")), options);
  ASSERT_EQ(graph.vertices.size(), 3u);
  EXPECT_EQ(graph.vertices[2].id, 9);
  EXPECT_EQ(graph.vertices[2].world_from_frame.translation, Eigen::Vector3d(2, 4, 6));
  EXPECT_THAT(note, HasSubstr("no vertex lines"));
}

TEST(G2o, IndefiniteInformationIsKeptAndCountedOrRefused) {
  const ScratchFolder folder;
  const auto path = folder.write(
      "a.g2o", kTwoVertices + edge("0 1") + "EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 1 1 2 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n");
  std::string note;
  G2oOptions options;
  options.warn = [&](const std::string& message) { note += message; };
  EXPECT_EQ(read_g2o(path, options).edges[1].information(0, 1), 2.0);
  EXPECT_THAT(note, HasSubstr("1 of 2 information matrices"));
  options.if_indefinite = G2oOptions::IfIndefinite::Refuse;
  EXPECT_THAT(message_of<InputError>([&] { read_g2o(path, options); }), HasSubstr("a.g2o:4"));
}

struct BrokenLine {
  std::string line;
  std::string what;
};

TEST(G2o, EveryBrokenLineIsNamed) {
  const ScratchFolder folder;
  const std::string information = kUnitInformation;
  const BrokenLine lines[] = {
      {"VERTEX_SE3:QUAT 2 0 0 0 0 0 1", "8 columns, not 9"},
      {"VERTEX_SE3:QUAT 2 0 0 0 0 0 0 1 5", "10 columns, not 9"},
      {"VERTEX_SE3:QUAT two 0 0 0 0 0 0 1", "'two' is not a vertex id"},
      {"VERTEX_SE3:QUAT 2 0 nan 0 0 0 0 1", "'nan' is not a finite number"},
      {"VERTEX_SE3:QUAT 2 0 inf 0 0 0 0 1", "'inf' is not a finite number"},
      {"VERTEX_SE3:QUAT 2 0 1,5 0 0 0 0 1", "'1,5' is not a finite number"},
      {"VERTEX_SE3:QUAT 2 0 0 0 0 0 0 0", "not of unit length"},
      {"VERTEX_SE3:QUAT 1 0 0 0 0 0 0 1", "vertex 1 is there twice"},
      {"VERTEX_SE2 2 0 0 0", "2-D and 3-D"},
      {"VERTEX_XY 2 0 0", "unknown tag 'VERTEX_XY'"},
      {"FIX", "FIX has no vertex id"},
      {"FIX 9", "there is no vertex 9"},
      {"EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 1 1 0 0", "columns, not 31"},
      {"EDGE_SE3:QUAT 0 9 1 2 3 0 0 0 1" + information, "there is no vertex 9"},
      {"EDGE_SE3:QUAT 1 1 1 2 3 0 0 0 1" + information, "joins vertex 1 to itself"},
      {"EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 2" + information, "not of unit length"},
      {"EDGE_SE3:QUAT 0 1 1 2 x 0 0 0 1" + information, "'x' is not a finite number"},
      {"EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 1 -1" + information.substr(2), "negative entry on its diagonal"},
      {"EDGE_SE3_PRIOR 0 4 1 2 3 0 0 0 1" + information, "there is no PARAMS_SE3OFFSET 4"},
      {"EDGE_SE3_PRIOR 9 1 2 3 0 0 0 1" + information, "there is no vertex 9"},
      {"PARAMS_SE3OFFSET 0 1 0 0 0 0 0 1", "not the identity"},
      {"EDGE_SE3_POSITION_PRIOR 0 1 2 3 1 0 0", "8 columns, not 11"},
      {"EDGE_SE3_ATTITUDE_PRIOR 0 0 0 0 2 1 0 0 1 0 1", "not of unit length"},
      {"EDGE_PRIOR_SE2_XY 0 1 2 1 0 1", "2-D and 3-D"},
      {"EDGE_SE3_DIRECTION:QUAT 0 1 0 0 0 0 0 0 1" + information, "length zero"},
  };
  for (const BrokenLine& broken : lines) {
    const auto path = folder.write("broken.g2o", kTwoVertices + broken.line + "\n" + edge("0 1"));
    const std::string message = message_of<InputError>([&] { read_g2o(path); });
    EXPECT_THAT(message, HasSubstr("broken.g2o:3: ")) << broken.line;
    EXPECT_THAT(message, HasSubstr(broken.what));
  }
}

TEST(G2o, PriorsRoundTripToTheSameBits) {
  const ScratchFolder folder;
  for (const int dimension : {2, 3}) {
    PoseGraph graph = test::random_graph(dimension, 6, 2, 0.1, 1);
    test::RandomPoses random(2);
    for (const PriorKind kind : {PriorKind::Pose, PriorKind::Position, PriorKind::Attitude}) {
      if (dimension == 2 && kind == PriorKind::Attitude) continue;
      VertexPrior prior;
      prior.vertex = 3;
      prior.kind = kind;
      prior.information.setZero();
      const int first = kind == PriorKind::Attitude ? 3 : 0;
      const int size = kind == PriorKind::Pose ? 6 : 3;
      prior.information.block(first, first, size, size) = random.information().topLeftCorner(size, size);
      if (kind != PriorKind::Attitude) prior.world_from_frame.translation.head(dimension) = random.vector().head(dimension);
      if (kind != PriorKind::Position && dimension == 3) prior.world_from_frame.rotation = random.pose(1.0).rotation;
      if (dimension == 2) {
        prior.information.middleRows<3>(2).setZero();
        prior.information.middleCols<3>(2).setZero();
      }
      graph.priors.push_back(prior);
    }
    write_g2o(folder.path() / "a.g2o", graph);
    const PoseGraph read = read_g2o(folder.path() / "a.g2o");
    ASSERT_EQ(read.priors.size(), graph.priors.size());
    for (std::size_t p = 0; p < graph.priors.size(); ++p) {
      EXPECT_EQ(read.priors[p].vertex, 3u);
      EXPECT_EQ(read.priors[p].kind, graph.priors[p].kind);
      EXPECT_EQ(read.priors[p].information, graph.priors[p].information);
      EXPECT_EQ(read.priors[p].world_from_frame.translation, graph.priors[p].world_from_frame.translation);
      EXPECT_EQ(read.priors[p].world_from_frame.rotation.coeffs(), graph.priors[p].world_from_frame.rotation.coeffs());
    }
  }
}

TEST(G2o, ReadsPriorsWithAndWithoutAnOffset) {
  const ScratchFolder folder;
  const std::string prior = " 1 2 3 0 0 0 1" + std::string(kUnitInformation) + "\n";
  const auto path = folder.write(
      "a.g2o", "PARAMS_SE3OFFSET 5 0 0 0 0 0 0 1\n" + kTwoVertices + "EDGE_SE3_PRIOR 1 5" + prior + "EDGE_SE3_PRIOR 0" + prior);
  const PoseGraph graph = read_g2o(path);
  ASSERT_EQ(graph.priors.size(), 2u);
  EXPECT_EQ(graph.priors[0].vertex, 1u);
  EXPECT_EQ(graph.priors[1].vertex, 0u);
  EXPECT_EQ(graph.priors[1].world_from_frame.translation, Eigen::Vector3d(1, 2, 3));
}

TEST(G2o, ReadsToro) {
  const ScratchFolder folder;
  const PoseGraph planar =
      read_g2o(folder.write("a.graph", "VERTEX2 0 0 0 0\nVERTEX2 1 1 2 0.5\nEDGE2 0 1 1 2 0.5 10 1 20 30 2 3\n"));
  EXPECT_EQ(planar.dimension, 2);
  const Matrix6d& information = planar.edges[0].information;
  EXPECT_EQ(information(0, 0), 10);
  EXPECT_EQ(information(0, 1), 1);
  EXPECT_EQ(information(1, 1), 20);
  EXPECT_EQ(information(5, 5), 30);
  EXPECT_EQ(information(0, 5), 2);
  EXPECT_EQ(information(5, 1), 3);
  const PoseGraph spatial =
      read_g2o(folder.write("b.graph", "VERTEX3 0 0 0 0 0 0 0\nVERTEX3 1 1 2 3 0.1 0.2 0.3\nEDGE3 0 1 1 2 3 0.1 0.2 0.3" +
                                           std::string(kUnitInformation) + "\n"));
  EXPECT_EQ(spatial.dimension, 3);
  // Turned about x first, then y, then z, all of the fixed frame.
  const Eigen::Quaterniond expected =
      test::rotation_from_vector({0, 0, 0.3}) * test::rotation_from_vector({0, 0.2, 0}) * test::rotation_from_vector({0.1, 0, 0});
  EXPECT_LT(rotation_angle(spatial.edges[0].from_from_to.rotation.conjugate() * expected), 1e-15);
  EXPECT_LT(evaluate_cost(spatial), 1e-20);
}

TEST(G2o, ToroRoundTrips) {
  const ScratchFolder folder;
  for (const int dimension : {2, 3}) {
    PoseGraph graph = test::random_graph(dimension, 12, 6, 0.1, 1);
    test::RandomPoses random(2);
    for (Edge& e : graph.edges) {
      e.information = random.information();
      // What is not of the plane is not written.
      if (dimension == 2) e.information.middleRows<3>(2).setZero(), e.information.middleCols<3>(2).setZero();
    }
    // Straight up, where roll and yaw turn about one axis.
    if (dimension == 3) graph.vertices[3].world_from_frame.rotation = Eigen::AngleAxisd(-0.5 * kPi, Eigen::Vector3d::UnitY());
    graph.edges[2].kind = EdgeKind::Neighbour;
    graph.vertices[1].fixed = true;
    write_toro(folder.path() / "a.graph", graph);
    const PoseGraph read = read_g2o(folder.path() / "a.graph");
    EXPECT_EQ(read.dimension, dimension);
    EXPECT_EQ(test::largest_distance(read, graph), 0.0);
    // Three turns and their angles round a few times; next to straight up, sines lose half of the digits.
    EXPECT_LT(test::largest_angle(read, graph), 1e-7);
    EXPECT_TRUE(read.vertices[1].fixed);
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
      EXPECT_EQ(read.edges[e].information, graph.edges[e].information);
      EXPECT_EQ(read.edges[e].kind, graph.edges[e].kind);
      const Eigen::Quaterniond& rotation = graph.edges[e].from_from_to.rotation;
      EXPECT_LT(rotation_angle(read.edges[e].from_from_to.rotation.conjugate() * rotation), 1e-13);
    }
  }
  PoseGraph directed = test::random_graph(3, 4, 1, 0.1, 1);
  directed.edges[1].has_scale = false;
  EXPECT_THAT(message_of<InputError>([&] { write_toro(folder.path() / "b.graph", directed); }), HasSubstr("edge 1"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "b.graph"));
}

TEST(G2o, EdgesWithoutInformationSayNothing) {
  const ScratchFolder folder;
  std::string zero;
  for (int k = 0; k < 21; ++k) zero += " 0";
  const auto path = folder.write("a.g2o", kTwoVertices + edge("0 1") + "EDGE_SE3:QUAT 1 0 9 9 9 0 0 0 1" + zero + "\n");
  PoseGraph graph = read_g2o(path);
  EXPECT_LT(optimize(graph, {.initialization = Initialization::LowestCost}).final_cost, 1e-20);
  EXPECT_LT((graph.vertices[1].world_from_frame.translation - Eigen::Vector3d(1, 2, 3)).norm(), 1e-6);
}

TEST(G2o, FilesThatAreNoGraphsAreRefused) {
  const ScratchFolder folder;
  EXPECT_THROW(read_g2o(folder.path() / "absent.g2o"), InputError);
  EXPECT_THROW(read_g2o(folder.path()), InputError);
  EXPECT_THROW(read_g2o(folder.write("empty.g2o", "# nothing\n")), InputError);
  EXPECT_THROW(write_g2o(folder.path() / "no" / "such" / "a.g2o", test::make_circle().graph), InputError);
}

}  // namespace
}  // namespace fabloop
