// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/g2o/similarity_g2o_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "frontend/error.h"
#include "tests/posegraph/random_graph.h"
#include "tests/posegraph/scratch_folder.h"

namespace fabloop {
namespace {

using test::message_of;
using test::RandomPoses;
using test::ScratchFolder;
using testing::HasSubstr;

constexpr const char* kUnitSimilarityInformation = " 1 0 0 0 0 0 0 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1";

/// Products of a few numbers near 1.
constexpr double kFileRounding = 1e-12;

std::string vertex(int id, const std::string& scale = "1") {
  return "VERTEX_SIM3:QUAT " + std::to_string(id) + " 1 2 3 0 0 0 1 " + scale + "\n";
}

SimilarityGraph random_similarities() {
  SimilarityGraph graph = similarity_graph_from(test::random_graph(3, 8, 4, 0.1, 1), 0.1);
  RandomPoses random(1);
  for (SimilarityVertex& v : graph.vertices) v.world_from_frame.scale = std::exp(random.number());
  for (SimilarityEdge& e : graph.edges) {
    e.from_from_to.scale = std::exp(random.number());
    Matrix7d root;
    for (double& entry : root.reshaped()) entry = random.number();
    e.information = (root * root.transpose()).eval();
    e.information = (0.5 * (e.information + e.information.transpose())).eval();
  }
  return graph;
}

TEST(SimilarityG2o, RoundTripsToTheSameBits) {
  const ScratchFolder folder;
  SimilarityGraph graph = random_similarities();
  graph.vertices[3].fixed = true;
  graph.vertices[4].id = -17;
  graph.edges[2].kind = EdgeKind::Neighbour;
  const auto path = folder.path() / "graph.g2o";
  write_g2o(path, graph);
  EXPECT_TRUE(has_similarities(path));
  const SimilarityGraph again = read_similarity_g2o(path);
  ASSERT_EQ(again.vertices.size(), graph.vertices.size());
  ASSERT_EQ(again.edges.size(), graph.edges.size());
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    EXPECT_EQ(again.vertices[v].id, graph.vertices[v].id);
    EXPECT_EQ(again.vertices[v].fixed, graph.vertices[v].fixed);
    EXPECT_EQ(again.vertices[v].world_from_frame.scale, graph.vertices[v].world_from_frame.scale);
    EXPECT_EQ(again.vertices[v].world_from_frame.translation, graph.vertices[v].world_from_frame.translation);
    EXPECT_EQ(again.vertices[v].world_from_frame.rotation.coeffs(), graph.vertices[v].world_from_frame.rotation.coeffs());
  }
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    EXPECT_EQ(again.edges[e].from, graph.edges[e].from);
    EXPECT_EQ(again.edges[e].to, graph.edges[e].to);
    EXPECT_EQ(again.edges[e].kind, graph.edges[e].kind);
    EXPECT_EQ(again.edges[e].information, graph.edges[e].information);
    EXPECT_EQ(again.edges[e].from_from_to.scale, graph.edges[e].from_from_to.scale);
    EXPECT_EQ(again.edges[e].from_from_to.translation, graph.edges[e].from_from_to.translation);
    EXPECT_EQ(again.edges[e].from_from_to.rotation.coeffs(), graph.edges[e].from_from_to.rotation.coeffs());
  }
}

/// A line of g2o's own form.
std::string exponential(const Similarity& similarity) {
  const Vector7d log = log_of(similarity);
  std::ostringstream text;
  text.precision(17);
  for (const int k : {3, 4, 5, 0, 1, 2, 6}) text << ' ' << log(k);
  return text.str();
}

TEST(SimilarityG2o, LogarithmsAreReadAsG2oWritesThem) {
  const ScratchFolder folder;
  const SimilarityGraph graph = random_similarities();
  const SimilarityEdge& edge = graph.edges.front();
  std::ostringstream text;
  text.precision(17);
  for (const std::size_t v : {0, 1}) {
    // The first with a calibration, as g2o does.
    text << "VERTEX_SIM3:EXPMAP " << v << exponential(graph.vertices[v].world_from_frame)
         << (v == 0 ? " 500 500 320 240\n" : "\n");
  }
  text << "EDGE_SIM3:EXPMAP 0 1" << exponential(edge.from_from_to);
  constexpr int kRotationFirst[] = {3, 4, 5, 0, 1, 2, 6};
  for (int i = 0; i < 7; ++i) {
    for (int j = i; j < 7; ++j) text << ' ' << edge.information(kRotationFirst[i], kRotationFirst[j]);
  }
  const SimilarityGraph read = read_similarity_g2o(folder.write("exponential.g2o", text.str() + "\n"));
  for (const std::size_t v : {0, 1}) {
    const Similarity& expected = graph.vertices[v].world_from_frame;
    EXPECT_LT(log_of(read.vertices[v].world_from_frame.inverse() * expected).norm(), kFileRounding * 1e2);
  }
  EXPECT_LT(log_of(read.edges[0].from_from_to.inverse() * edge.from_from_to).norm(), kFileRounding * 1e2);
  EXPECT_LT((read.edges[0].information - edge.information).norm(), kFileRounding * 1e2);
}

TEST(SimilarityG2o, FilesWithoutVerticesAreChained) {
  const ScratchFolder folder;
  const auto path = folder.write("edges.g2o", "EDGE_SIM3:QUAT 5 7 1 0 0 0 0 0 1 2" + std::string(kUnitSimilarityInformation) +
                                                  "\nEDGE_SIM3:QUAT 7 9 1 0 0 0 0 0 1 2" + kUnitSimilarityInformation + "\n");
  const SimilarityGraph graph = read_similarity_g2o(path);
  ASSERT_EQ(graph.vertices.size(), 3u);
  EXPECT_EQ(graph.vertices[2].id, 9);
  EXPECT_EQ(graph.vertices[2].world_from_frame.scale, 4.0);
  EXPECT_EQ(graph.vertices[2].world_from_frame.translation, Eigen::Vector3d(3, 0, 0));
}

TEST(SimilarityG2o, NamesTheLineThatIsWrong) {
  const ScratchFolder folder;
  const auto message = [&](const std::string& text) {
    const auto path = folder.write("bad.g2o", text);
    return message_of<InputError>([&] { read_similarity_g2o(path); });
  };
  EXPECT_THAT(message(vertex(0) + vertex(1, "0")), HasSubstr("bad.g2o:2: the scale '0' is not positive"));
  EXPECT_THAT(message(vertex(0) + vertex(0)), HasSubstr("bad.g2o:2: vertex 0 is there twice"));
  EXPECT_THAT(message("VERTEX_SIM3:QUAT 0 1 2 3 0 0 0 1\n"), HasSubstr("has 9 columns, not 10"));
  EXPECT_THAT(message(vertex(0) + "EDGE_SE3:QUAT 0 1\n"), HasSubstr("bad.g2o:2: unknown tag 'EDGE_SE3:QUAT'"));
  EXPECT_THAT(message(vertex(0) + "EDGE_SIM3:QUAT 0 1 1 0 0 0 0 0 1 1" + kUnitSimilarityInformation + "\n"),
              HasSubstr("bad.g2o:2: there is no vertex 1"));
  EXPECT_THAT(message("# nothing\n"), HasSubstr("has no vertices and no edges"));
}

}  // namespace
}  // namespace fabloop
