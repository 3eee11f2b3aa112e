// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/connectivity.h"

#include <gtest/gtest.h>

#include "tests/posegraph/synthetic_graph.h"

namespace fabloop {
namespace {

TEST(Connectivity, ComponentsAreNumberedByTheirFirstVertices) {
  PoseGraph graph;
  graph.vertices.resize(6);
  graph.edges.resize(3);
  graph.edges[0].from = 5, graph.edges[0].to = 1;
  graph.edges[1].from = 4, graph.edges[1].to = 2;
  graph.edges[2].from = 1, graph.edges[2].to = 3;
  const Components components = connected_components(graph);
  EXPECT_EQ(components.count, 3u);
  EXPECT_EQ(components.of_vertex, (std::vector<std::size_t>{0, 1, 2, 1, 2, 1}));
}

TEST(Connectivity, ChainingPlacesEveryVertexFromTheFixedOne) {
  PoseGraph graph = test::make_circle().truth;
  const PoseGraph truth = graph;
  graph.vertices[9].fixed = true;
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    if (v != 9) graph.vertices[v].world_from_frame = {};
  }
  chain_along_edges(graph);
  EXPECT_LT(test::largest_distance(graph, truth), 1e-9);
  EXPECT_LT(test::largest_angle(graph, truth), 1e-7);
}

TEST(Connectivity, ChainingPrefersEdgesWithScale) {
  PoseGraph graph;
  graph.vertices.resize(2);
  graph.edges.resize(2);
  for (Edge& edge : graph.edges) edge.to = 1;
  graph.edges[0].has_scale = false;
  graph.edges[0].from_from_to.translation = {1, 0, 0};
  graph.edges[1].from_from_to.translation = {5, 0, 0};
  chain_along_edges(graph);
  EXPECT_EQ(graph.vertices[1].world_from_frame.translation, Eigen::Vector3d(5, 0, 0));
}

}  // namespace
}  // namespace fabloop
