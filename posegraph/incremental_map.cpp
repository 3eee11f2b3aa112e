// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/incremental_map.h"

#include <algorithm>
#include <string>

#include "frontend/error.h"
#include "posegraph/map_skeleton.h"

namespace fabloop {
namespace {

/// The checks that check() makes of one edge, without walking through the whole graph.
void check_edge(const PoseGraph& graph, const Edge& edge) {
  PoseGraph ends;
  ends.dimension = graph.dimension;
  if (edge.from < graph.vertices.size()) ends.vertices.push_back(graph.vertices[edge.from]);
  if (edge.to < graph.vertices.size()) ends.vertices.push_back(graph.vertices[edge.to]);
  const bool are_there = ends.vertices.size() == 2;
  Edge between = edge;
  between.from = 0;
  between.to = edge.from == edge.to ? 0 : are_there ? 1 : 2;
  ends.edges.push_back(between);
  check(ends);
}

}  // namespace

std::size_t IncrementalMap::add_keyframe(std::int64_t id, const Pose& odom_from_body, const Matrix6d& information) {
  Vertex vertex{id, odom_from_body, graph_.vertices.empty()};
  if (!odom_from_body.translation.allFinite() || !odom_from_body.rotation.coeffs().allFinite()) {
    throw InputError("incremental map: keyframe " + std::to_string(id) +
                     " has an odometry pose that is not finite; leave it out");
  }
  if (!graph_.vertices.empty()) {
    Edge edge;
    edge.from = graph_.vertices.size() - 1;
    edge.to = graph_.vertices.size();
    edge.from_from_to = odom_from_newest_.inverse() * odom_from_body;
    edge.information = information;
    if (!information.allFinite()) {
      throw InputError("incremental map: keyframe " + std::to_string(id) + " has an information that is not finite");
    }
    vertex.world_from_frame = graph_.vertices.back().world_from_frame * edge.from_from_to;
    graph_.edges.push_back(edge);
  }
  graph_.vertices.push_back(vertex);
  odom_from_newest_ = odom_from_body;
  return graph_.vertices.size() - 1;
}

void IncrementalMap::add_edge(const Edge& edge) {
  check_edge(graph_, edge);
  graph_.edges.push_back(edge);
}

IncrementalStep IncrementalMap::step() {
  const auto first_new = graph_.edges.begin() + static_cast<std::ptrdiff_t>(num_edges_taken_in_);
  const bool has_loop = std::any_of(first_new, graph_.edges.end(), [](const Edge& edge) { return edge.kind == EdgeKind::Loop; });
  const bool has_neighbour =
      std::any_of(first_new, graph_.edges.end(), [](const Edge& edge) { return edge.kind == EdgeKind::Neighbour; });
  num_edges_taken_in_ = graph_.edges.size();
  if (has_loop) is_settled_ = false;
  IncrementalStep step;
  if (!is_settled_) {
    step = solve_map();
    is_settled_ = step.report.termination != Termination::MaxIterations ||
                  step.report.initial_cost - step.report.final_cost <= options_.settled_tolerance * step.report.initial_cost;
  } else if (has_neighbour) {
    step.kind = IncrementalStep::Kind::Window;
    step.report = solve_window();
  }
  return step;
}

IncrementalStep IncrementalMap::solve_map() {
  OptimizeOptions options = options_.optimize;
  options.max_iterations = options_.whole_map_iterations;
  if (graph_.vertices.size() <= options_.max_pieces) return {IncrementalStep::Kind::WholeMap, optimize(graph_, options)};
  MapSkeleton skeleton = make_skeleton(graph_, options_.max_pieces);
  IncrementalStep step{IncrementalStep::Kind::Pieces, optimize(skeleton.graph, options)};
  follow_skeleton(skeleton, graph_);
  return step;
}

OptimizeReport IncrementalMap::solve_window() {
  const std::size_t size = graph_.vertices.size();
  const std::size_t first = size - std::min(size, options_.window);
  PoseGraph window;
  window.dimension = graph_.dimension;
  // Edges that reach back hold the window; their far ends come along, fixed. New edges stand at the end.
  std::vector<std::size_t> outside;
  const auto position = [&](std::size_t v) {
    if (v >= first) return v - first;
    const auto place = static_cast<std::size_t>(std::find(outside.begin(), outside.end(), v) - outside.begin());
    if (place == outside.size()) outside.push_back(v);
    return size - first + place;
  };
  for (std::size_t e = graph_.edges.size(); e-- > 0;) {
    const Edge& edge = graph_.edges[e];
    if (std::max(edge.from, edge.to) < first) {
      // Odometry comes in order: what was added before the window's first vertex cannot touch it.
      if (edge.kind == EdgeKind::Odometry && edge.to + 1 == first) break;
      continue;
    }
    Edge local = edge;
    local.from = position(edge.from);
    local.to = position(edge.to);
    window.edges.push_back(local);
  }
  window.vertices.assign(graph_.vertices.begin() + static_cast<std::ptrdiff_t>(first), graph_.vertices.end());
  for (const std::size_t v : outside) {
    window.vertices.push_back(graph_.vertices[v]);
    window.vertices.back().fixed = true;
  }
  const OptimizeReport report = optimize(window, options_.optimize);
  std::copy_n(window.vertices.begin(), size - first, graph_.vertices.begin() + static_cast<std::ptrdiff_t>(first));
  return report;
}

OptimizeReport IncrementalMap::finish() {
  num_edges_taken_in_ = graph_.edges.size();
  is_settled_ = true;
  return optimize(graph_, options_.optimize);
}

Pose IncrementalMap::map_from_odom() const {
  if (graph_.vertices.empty()) return {};
  return graph_.vertices.back().world_from_frame * odom_from_newest_.inverse();
}

}  // namespace fabloop
