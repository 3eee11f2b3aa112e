// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posegraph/pose_graph.h"
#include "posegraph/similarity_graph.h"

/// Graphs of similarities as pose graphs (private).
namespace fabloop {

/// The graph without scales: who is joined to whom, which vertices are fixed, rotations, and translations in the units they are
/// in.
inline PoseGraph rigid_part(const SimilarityGraph& graph) {
  PoseGraph rigid;
  rigid.vertices.reserve(graph.vertices.size());
  rigid.edges.reserve(graph.edges.size());
  for (const SimilarityVertex& vertex : graph.vertices) {
    rigid.vertices.push_back({vertex.id, pose_of(vertex.world_from_frame), vertex.fixed});
  }
  for (const SimilarityEdge& edge : graph.edges) {
    rigid.edges.push_back(
        {edge.from, edge.to, pose_of(edge.from_from_to), edge.information.topLeftCorner<6, 6>(), edge.kind, true});
  }
  return rigid;
}

/// Takes rotations and translations from a pose graph of the same vertices.
inline void set_rigid_part(const PoseGraph& rigid, SimilarityGraph& graph) {
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    graph.vertices[v].world_from_frame.rotation = rigid.vertices[v].world_from_frame.rotation;
    graph.vertices[v].world_from_frame.translation = rigid.vertices[v].world_from_frame.translation;
  }
}

}  // namespace fabloop
