// SPDX-License-Identifier: BSD-3-Clause
// The README's example, compiled. structure_test compares the two.
#include <filesystem>
#include <iostream>

#include "frontend/fabmap/model.h"
#include "frontend/sequence/sequence.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/optimize.h"
#include "verification/ledger.h"
#include "verification/loop_closer.h"

void close_loops(const std::filesystem::path& folder);

// README begins
using namespace fabloop;

void close_loops(const std::filesystem::path& folder) {
  const Sequence sequence = read_sequence(folder, {.odometry = folder / "odometry.tum"});
  LoopCloser loop_closer(sequence.camera, read_model("fields.model"));
  PoseGraph graph;
  for (const Frame& frame : sequence.frames) {
    if (!frame.odom_from_camera) continue;
    const std::size_t now = graph.vertices.size();
    // An image or your own features; with them, where you have them, the step's covariance and points or a depth image.
    const LoopEvent event = loop_closer.add_keyframe({.frame = now,
                                                      .time_ns = frame.time_ns,
                                                      .odom_from_body = *frame.odom_from_camera,
                                                      .image = read_gray_image(frame.image_path, sequence.camera)});
    write_ledger(std::cout, event, LedgerFormat::Csv);  // every hypothesis, its verdict and the figures behind it

    graph.vertices.push_back({static_cast<std::int64_t>(now), *frame.odom_from_camera});
    if (now > 0) {
      const Pose previous_from_now = graph.vertices[now - 1].world_from_frame.inverse() * *frame.odom_from_camera;
      graph.edges.push_back({now - 1, now, previous_from_now});
    }
    for (const LoopClosure& loop : event.loops) {
      // match_from_query, its information matrix, and whether its length is known or only its direction
      graph.edges.push_back({loop.match, loop.query, loop.match_from_query, loop.information, EdgeKind::Loop, loop.has_scale});
    }
  }
  std::cout << optimize(graph, {.robust_loss = RobustLoss::Cauchy}).brief() << '\n';
  write_g2o("graph.g2o", graph);
}
// README ends

int main() { return 0; }
