// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/map_skeleton.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <set>
#include <utility>

#include "posegraph/robust/odometry_tree.h"
#include "verification/uncertain_pose.h"

namespace fabloop {
namespace {

UncertainPose measured(const Edge& edge, int dimension) { return {edge.from_from_to, edge_covariance(edge, dimension)}; }

Edge edge_between(std::size_t from, std::size_t to, const UncertainPose& from_from_to, const Edge& like) {
  Edge edge = like;
  edge.from = from;
  edge.to = to;
  edge.from_from_to = from_from_to.pose;
  edge.information = from_from_to.covariance.inverse();
  return edge;
}

}  // namespace

MapSkeleton make_skeleton(const PoseGraph& graph, std::size_t max_vertices) {
  assert(graph.dimension == 3 && !graph.vertices.empty());
  const std::size_t size = graph.vertices.size();
  const std::size_t stride = std::max<std::size_t>(1, (size + max_vertices - 1) / max_vertices);
  MapSkeleton skeleton;
  for (std::size_t v = 0; v < size; v += stride) skeleton.kept.push_back(v);
  if (skeleton.kept.back() != size - 1) skeleton.kept.push_back(size - 1);
  for (const std::size_t v : skeleton.kept) skeleton.graph.vertices.push_back(graph.vertices[v]);
  const auto piece_of = [&](std::size_t v) { return v == size - 1 ? skeleton.kept.size() - 1 : v / stride; };

  // Each vertex as odometry has it from where its piece begins.
  std::vector<UncertainPose> begin_from_vertex(size);
  for (const Edge& edge : graph.edges) {
    if (edge.kind != EdgeKind::Odometry) continue;
    const UncertainPose begin_from_to = begin_from_vertex[edge.from] * measured(edge, graph.dimension);
    const std::size_t piece = piece_of(edge.from);
    if (piece_of(edge.to) == piece) {
      begin_from_vertex[edge.to] = begin_from_to;
    } else {
      skeleton.graph.edges.push_back(edge_between(piece, piece + 1, begin_from_to, edge));
    }
  }
  std::set<std::pair<std::size_t, std::size_t>> joined;
  for (auto edge = graph.edges.rbegin(); edge != graph.edges.rend(); ++edge) {
    const std::size_t from = piece_of(edge->from);
    const std::size_t to = piece_of(edge->to);
    // A direction cannot be carried elsewhere, and odometry is there already.
    if (edge->kind == EdgeKind::Odometry || !edge->has_scale || from == to) continue;
    if (!joined.insert(std::minmax(from, to)).second) continue;
    const UncertainPose carried =
        begin_from_vertex[edge->from] * measured(*edge, graph.dimension) * inverse(begin_from_vertex[edge->to]);
    skeleton.graph.edges.push_back(edge_between(from, to, carried, *edge));
  }
  return skeleton;
}

void follow_skeleton(const MapSkeleton& skeleton, PoseGraph& graph) {
  for (std::size_t piece = 0; piece + 1 < skeleton.kept.size(); ++piece) {
    const std::size_t first = skeleton.kept[piece];
    const std::size_t last = skeleton.kept[piece + 1];
    const Pose first_from_old = graph.vertices[first].world_from_frame.inverse();
    const Pose last_from_old = graph.vertices[last].world_from_frame.inverse();
    const Pose& new_first = skeleton.graph.vertices[piece].world_from_frame;
    const Pose& new_last = skeleton.graph.vertices[piece + 1].world_from_frame;
    for (std::size_t v = first + 1; v < last; ++v) {
      Pose& pose = graph.vertices[v].world_from_frame;
      const Pose with_first = new_first * (first_from_old * pose);
      const Pose with_last = new_last * (last_from_old * pose);
      const double share = static_cast<double>(v - first) / static_cast<double>(last - first);
      pose = {with_first.rotation.slerp(share, with_last.rotation),
              (1.0 - share) * with_first.translation + share * with_last.translation};
    }
    graph.vertices[first].world_from_frame = new_first;
  }
  graph.vertices[skeleton.kept.back()].world_from_frame = skeleton.graph.vertices.back().world_from_frame;
}

}  // namespace fabloop
