// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "posegraph/connectivity.h"
#include "posegraph/evaluation/trajectory_error.h"
#include "posegraph/initialization.h"

namespace fabloop {
namespace {

/// The priors of one component, as positions in `PoseGraph::priors`.
struct PriorsOfComponent {
  std::vector<std::size_t> poses;
  std::vector<std::size_t> positions;
  bool has_fixed_vertex = false;
};

std::vector<PriorsOfComponent> sort_priors(const PoseGraph& graph, const Components& components) {
  std::vector<PriorsOfComponent> result(components.count);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    if (graph.vertices[v].fixed) result[components.of_vertex[v]].has_fixed_vertex = true;
  }
  for (std::size_t p = 0; p < graph.priors.size(); ++p) {
    PriorsOfComponent& priors = result[components.of_vertex[graph.priors[p].vertex]];
    // An altitude alone does not say where.
    const bool is_position = graph.priors[p].kind == PriorKind::Position && graph.priors[p].information(0, 0) > 0.0 &&
                             graph.priors[p].information(1, 1) > 0.0;
    if (graph.priors[p].kind == PriorKind::Pose) priors.poses.push_back(p);
    if (is_position) priors.positions.push_back(p);
  }
  return result;
}

/// world_from_old of the rigid motion.
std::optional<Pose> motion_to_positions(const PoseGraph& graph, const std::vector<std::size_t>& positions) {
  if (positions.empty()) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(positions.size());
  Eigen::Matrix3Xd now(3, count);
  Eigen::Matrix3Xd wanted(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const VertexPrior& prior = graph.priors[positions[static_cast<std::size_t>(k)]];
    now.col(k) = graph.vertices[prior.vertex].world_from_frame.translation;
    wanted.col(k) = prior.world_from_frame.translation;
    // Without information on height, take the one there is.
    if (graph.dimension == 3 && prior.information(2, 2) == 0.0) wanted(2, k) = now(2, k);
  }
  constexpr Eigen::Index kMinToTurn = 3;
  if (count >= kMinToTurn) {
    if (const std::optional<Similarity> similarity = align_points(now, wanted, Alignment::Se3)) {
      return pose_of(*similarity);
    }
  }
  return Pose{Eigen::Quaterniond::Identity(), wanted.rowwise().mean() - now.rowwise().mean()};
}

}  // namespace

void move_to_priors(PoseGraph& graph) {
  const Components components = connected_components(graph);
  const std::vector<PriorsOfComponent> priors = sort_priors(graph, components);
  std::vector<std::optional<Pose>> motions(components.count);
  for (std::size_t c = 0; c < components.count; ++c) {
    if (priors[c].has_fixed_vertex) continue;
    if (!priors[c].poses.empty()) {
      const VertexPrior& prior = graph.priors[priors[c].poses.front()];
      motions[c] = prior.world_from_frame * graph.vertices[prior.vertex].world_from_frame.inverse();
    } else {
      motions[c] = motion_to_positions(graph, priors[c].positions);
    }
  }
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    Pose& pose = graph.vertices[v].world_from_frame;
    if (const auto& motion = motions[components.of_vertex[v]]) pose = *motion * pose;
  }
}

}  // namespace fabloop
