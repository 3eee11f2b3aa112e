// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/back_end_trial.h"

#include <gtest/gtest.h>

namespace fabloop {
namespace {

Edge edge_of(std::size_t from, std::size_t to, double forward_m, EdgeKind kind, bool has_scale) {
  Edge edge;
  edge.from = from;
  edge.to = to;
  edge.from_from_to.translation = {forward_m, 0.0, 0.0};
  edge.kind = kind;
  edge.has_scale = has_scale;
  return edge;
}

TEST(BackEndTrial, StartsWhereOdometryLeadsWhateverLoopsAndNeighboursSay) {
  constexpr double kSpacingM = 5.0;
  PoseGraph graph;
  for (std::size_t i = 0; i < 5; ++i) {
    Vertex vertex;
    vertex.id = static_cast<std::int64_t>(i);
    // As a map that false loops have bent.
    vertex.world_from_frame.translation = {0.0, i > 0 ? 100.0 : 0.0, 0.0};
    graph.vertices.push_back(vertex);
    if (i > 0) graph.edges.push_back(edge_of(i - 1, i, kSpacingM, EdgeKind::Odometry, true));
  }
  // The mapper's neighbours, 1, 2 and 4 frames back, know a direction only.
  for (const std::size_t distance : {1, 2, 4}) graph.edges.push_back(edge_of(4 - distance, 4, 1.0, EdgeKind::Neighbour, false));
  graph.edges.push_back(edge_of(0, 3, 0.5, EdgeKind::Loop, true));
  start_from_odometry(graph);
  for (std::size_t i = 0; i < 5; ++i) {
    const Eigen::Vector3d expected(kSpacingM * static_cast<double>(i), 0.0, 0.0);
    EXPECT_LT((graph.vertices[i].world_from_frame.translation - expected).norm(), 1e-9) << "vertex " << i;
  }
}

}  // namespace
}  // namespace fabloop
