// SPDX-License-Identifier: BSD-3-Clause
// The README's example, compiled. structure_test compares the two.
#include <filesystem>
#include <iostream>

#include "frontend/fabmap/model.h"
#include "frontend/features/feature_extractor.h"
#include "frontend/sequence/sequence.h"
#include "posegraph/g2o_io.h"
#include "posegraph/optimize.h"
#include "verification/loop_closer.h"

void close_loops(const std::filesystem::path& folder);

// README begins
using namespace fabloop;

void close_loops(const std::filesystem::path& folder) {
  const Sequence sequence = read_sequence(folder, {.odometry = folder / "odometry.tum"});
  const Model model = read_model("fields.model");
  const FeatureExtractor extractor(model.features);
  LoopCloser loop_closer(sequence.camera, model);
  PoseGraph graph;
  for (const Frame& frame : sequence.frames) {
    if (!frame.odom_from_camera) continue;
    const std::size_t now = graph.vertices.size();
    const Features features = extractor.extract(read_gray_image(frame.image_path, sequence.camera));
    const LoopEvent event = loop_closer.add_keyframe({now, features, *frame.odom_from_camera});

    graph.vertices.push_back({static_cast<std::int64_t>(now), *frame.odom_from_camera});
    if (now > 0) {
      const Pose previous_from_now = graph.vertices[now - 1].world_from_frame.inverse() * *frame.odom_from_camera;
      graph.edges.push_back({now - 1, now, previous_from_now});
    }
    for (const HypothesisOutcome& place : event.hypotheses) {
      const Verification& proof = place.verification;
      std::cout << now << " seen at " << place.match << "? p = " << place.probability << ": " << to_string(proof.verdict) << '\n';
      if (proof.verdict != Verdict::Accepted) continue;
      // match_from_query, its information matrix, and whether its length is known or only its direction
      graph.edges.push_back({place.match, now, proof.match_from_query, proof.information, EdgeKind::Loop, proof.has_scale});
    }
  }
  std::cout << optimize(graph, {.robust_loss = RobustLoss::Cauchy}).brief() << '\n';
  write_g2o("graph.g2o", graph);
}
// README ends

int main() { return 0; }
