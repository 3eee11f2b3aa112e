// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/pose_graph.h"

#include <string>

#include "frontend/error.h"

namespace fabloop {

void check(const PoseGraph& graph) {
  const auto is_finite = [](const Pose& pose) { return pose.rotation.coeffs().allFinite() && pose.translation.allFinite(); };
  if (graph.dimension != 2 && graph.dimension != 3) throw InputError("pose graph: dimension must be 2 or 3");
  for (const Vertex& vertex : graph.vertices) {
    if (!is_finite(vertex.world_from_frame)) {
      throw InputError("pose graph: vertex " + std::to_string(vertex.id) + " has a pose that is not finite");
    }
  }
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const Edge& edge = graph.edges[e];
    const auto fail = [&](const std::string& what) {
      throw InputError("pose graph: edge " + std::to_string(e) + " (counted from 0) " + what);
    };
    if (edge.from >= graph.vertices.size() || edge.to >= graph.vertices.size()) fail("refers to a vertex that is not there");
    if (edge.from == edge.to) fail("joins a vertex to itself");
    if (!is_finite(edge.from_from_to) || !edge.information.allFinite()) fail("has numbers that are not finite");
    if (!edge.has_scale && graph.dimension == 2) fail("has no scale, which planar graphs do not support");
    if (!edge.has_scale && edge.from_from_to.translation.norm() == 0.0) fail("has neither scale nor a direction");
  }
  for (std::size_t p = 0; p < graph.priors.size(); ++p) {
    const VertexPrior& prior = graph.priors[p];
    const auto fail = [&](const std::string& what) {
      throw InputError("pose graph: prior " + std::to_string(p) + " (counted from 0) " + what);
    };
    if (prior.vertex >= graph.vertices.size()) fail("refers to a vertex that is not there");
    if (!is_finite(prior.world_from_frame) || !prior.information.allFinite()) fail("has numbers that are not finite");
    if (prior.kind == PriorKind::Attitude && graph.dimension == 2) fail("is an attitude, which planar graphs do not have");
  }
}

}  // namespace fabloop
