// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "posegraph/pose_graph.h"

/// The poses as the solver moves them (private).
namespace fabloop {

/// A vertex: quaternion (x y z w) and translation, or (x, y, yaw) in the first three.
using State = std::array<double, 7>;

inline std::vector<State> read_states(const PoseGraph& graph) {
  std::vector<State> states;
  states.reserve(graph.vertices.size());
  for (const Vertex& vertex : graph.vertices) {
    const auto& [q, t] = vertex.world_from_frame;
    if (graph.dimension == 2) {
      states.push_back({t.x(), t.y(), 2.0 * std::atan2(q.z(), q.w())});
    } else {
      states.push_back({q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()});
    }
  }
  return states;
}

inline Pose pose_from_state(const State& s, int dimension) {
  if (dimension == 2) return {Eigen::Quaterniond(std::cos(0.5 * s[2]), 0.0, 0.0, std::sin(0.5 * s[2])), {s[0], s[1], 0.0}};
  return {Eigen::Quaterniond(s[3], s[0], s[1], s[2]).normalized(), {s[4], s[5], s[6]}};
}

/// The parameter blocks of an edge's residual.
inline std::vector<double*> blocks_of(const Edge& edge, int dimension, std::vector<State>& states) {
  double* const i = states[edge.from].data();
  double* const j = states[edge.to].data();
  if (dimension == 2) return {i, j};
  return {i, i + 4, j, j + 4};
}

}  // namespace fabloop
