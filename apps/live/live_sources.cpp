// SPDX-License-Identifier: BSD-3-Clause
#include "apps/live/live_sources.h"

#include <algorithm>

#include "posegraph/sfm/reconstruction_graph.h"

namespace fabloop::apps {

LiveMap live_map_of(const Map& map) {
  LiveMap live;
  for (std::size_t v = 0; v < map.graph.vertices.size(); ++v) {
    const Vertex& vertex = map.graph.vertices[v];
    const auto frame = static_cast<std::size_t>(vertex.id);
    live.placed.push_back({frame, vertex.world_from_frame.translation});
    live.odometry.push_back({frame, map.odometry_trajectory[v].world_from_camera.translation});
  }
  for (const LoopEvent& event : map.events) {
    for (const HypothesisOutcome& outcome : event.hypotheses) {
      if (outcome.match_session != event.session) continue;
      const Verification& verification = outcome.verification;
      live.loops.push_back({event.query, outcome.match, verification.verdict, verification.num_inliers});
    }
  }
  if (!live.placed.empty()) live.newest = live.placed.back().frame;
  return live;
}

LiveMap live_map_of(const PlacedSoFar& so_far) {
  LiveMap live;
  if (so_far.unit == LengthUnit::Arbitrary) live.unit = "units";
  for (std::size_t view = 0; view < so_far.views.size(); ++view) {
    const auto& world_from_camera = so_far.segment.world_from_cameras[view];
    if (world_from_camera) live.placed.push_back({so_far.views[view].frame, world_from_camera->translation});
  }
  for (const ViewPair& pair : so_far.pairs) {
    const std::size_t a = so_far.views[pair.query].frame, b = so_far.views[pair.match].frame;
    if (std::max(a, b) - std::min(a, b) <= ReconstructionGraphOptions{}.num_neighbours) continue;
    live.loops.push_back({std::max(a, b), std::min(a, b), Verdict::Accepted, static_cast<int>(pair.inliers.size())});
  }
  return live;
}

}  // namespace fabloop::apps
