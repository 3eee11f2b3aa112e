// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <random>

#include "posegraph/pose_graph.h"
#include "tests/posegraph/synthetic_graph.h"

namespace fabloop::test {

struct LongWalkOptions {
  std::size_t num_poses = 5000;
  std::size_t lap = 500;       ///< Poses in a lap; a loop joins a pose to the one a lap before.
  std::size_t loop_every = 2;  ///< Every so many poses there is a loop.
  std::uint32_t seed = 1;
};

/// A walk round and round with noisy steps and loops; vertices stand where odometry leads. Edges come in the order in which they
/// are known: each loop after the odometry edge that leads to its later end.
inline PoseGraph make_long_walk(const LongWalkOptions& options) {
  constexpr double kStep = 1.0;
  constexpr double kSigmaTranslation = 0.02;
  constexpr double kSigmaRotation = 0.001;
  std::mt19937 random(options.seed);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    return Eigen::Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random));
  };
  const double turn = 2.0 * kPi / static_cast<double>(options.lap);
  const Pose true_step{rotation_from_vector({0.0, 0.0, turn}), {kStep, 0.0, 0.0}};
  PoseGraph graph;
  const auto add = [&](std::size_t from, std::size_t to, const Pose& from_from_to, EdgeKind kind) {
    Edge edge;
    edge.from = from;
    edge.to = to;
    edge.kind = kind;
    edge.from_from_to = from_from_to * Pose{rotation_from_vector(noise(kSigmaRotation)), noise(kSigmaTranslation)};
    edge.information.topLeftCorner<3, 3>() /= kSigmaTranslation * kSigmaTranslation;
    edge.information.bottomRightCorner<3, 3>() /= kSigmaRotation * kSigmaRotation;
    graph.edges.push_back(edge);
  };
  for (std::size_t k = 0; k < options.num_poses; ++k) {
    graph.vertices.push_back({static_cast<std::int64_t>(k), {}, k == 0});
    if (k == 0) continue;
    add(k - 1, k, true_step, EdgeKind::Odometry);
    graph.vertices[k].world_from_frame = graph.vertices[k - 1].world_from_frame * graph.edges.back().from_from_to;
    // A lap leads back to the same pose.
    if (k >= options.lap && k % options.loop_every == 0) add(k - options.lap, k, {}, EdgeKind::Loop);
  }
  return graph;
}

}  // namespace fabloop::test
