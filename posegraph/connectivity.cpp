// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/connectivity.h"

#include <algorithm>
#include <deque>

#include "posegraph/disjoint_sets.h"

namespace fabloop {
namespace {

/// Edges of each vertex, those with scale first, in the graph's order.
std::vector<std::vector<std::size_t>> edges_of_vertices(const PoseGraph& graph) {
  std::vector<std::vector<std::size_t>> result(graph.vertices.size());
  for (const bool has_scale : {true, false}) {
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
      if (graph.edges[e].has_scale != has_scale) continue;
      result[graph.edges[e].from].push_back(e);
      result[graph.edges[e].to].push_back(e);
    }
  }
  return result;
}

}  // namespace

Components connected_components(const PoseGraph& graph) {
  DisjointSets sets(graph.vertices.size());
  for (const Edge& edge : graph.edges) sets.join(edge.from, edge.to);
  Components components;
  components.of_vertex.resize(graph.vertices.size());
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    const std::size_t root = sets.root_of(v);  // a component's first vertex
    components.of_vertex[v] = root == v ? components.count++ : components.of_vertex[root];
  }
  return components;
}

std::vector<std::size_t> find_anchors(const PoseGraph& graph, const Components& components) {
  std::vector<bool> has_anchor(components.count, false);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    if (graph.vertices[v].fixed) has_anchor[components.of_vertex[v]] = true;
  }
  std::vector<std::size_t> anchors;
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    const std::size_t component = components.of_vertex[v];
    if (graph.vertices[v].fixed || !has_anchor[component]) anchors.push_back(v);
    has_anchor[component] = true;
  }
  return anchors;
}

std::vector<EdgeStep> breadth_first(const PoseGraph& graph) {
  std::vector<EdgeStep> steps;
  const auto edges_of = edges_of_vertices(graph);
  const Components components = connected_components(graph);
  std::vector<bool> reached(graph.vertices.size(), false);
  std::vector<bool> started(components.count, false);
  std::deque<std::size_t> queue;
  const auto start_at = [&](std::size_t v) {
    reached[v] = started[components.of_vertex[v]] = true;
    queue.push_back(v);
  };
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    if (graph.vertices[v].fixed) start_at(v);
  }
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    if (!started[components.of_vertex[v]]) start_at(v);
  }
  for (; !queue.empty(); queue.pop_front()) {
    const std::size_t v = queue.front();
    for (const std::size_t e : edges_of[v]) {
      const Edge& edge = graph.edges[e];
      const std::size_t other = edge.from == v ? edge.to : edge.from;
      if (reached[other]) continue;
      steps.push_back({e, v, other});
      reached[other] = true;
      queue.push_back(other);
    }
  }
  return steps;
}

void chain_along_edges(PoseGraph& graph) {
  for (const EdgeStep& step : breadth_first(graph)) {
    const Edge& edge = graph.edges[step.edge];
    const Pose from_from_to = edge.from == step.from ? edge.from_from_to : edge.from_from_to.inverse();
    graph.vertices[step.to].world_from_frame = graph.vertices[step.from].world_from_frame * from_from_to;
  }
}

}  // namespace fabloop
