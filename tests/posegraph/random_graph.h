// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>

#include "posegraph/pose_graph.h"

namespace fabloop::test {

/// Seeded poses and information matrices.
class RandomPoses {
 public:
  explicit RandomPoses(std::uint32_t seed) : random_(seed) {}

  double number() { return normal_(random_); }
  Eigen::Vector3d vector() { return {number(), number(), number()}; }

  /// Any rotation, and a translation of about `size_m`.
  Pose pose(double size_m) {
    return {Eigen::Quaterniond(number(), number(), number(), number()).normalized(), size_m * vector()};
  }
  /// A rotation of about `size_rad`, and a translation of about `size_m`.
  Pose pose(double size_m, double size_rad) { return {rotation_from_vector(size_rad * vector()), size_m * vector()}; }
  Pose planar_pose(double size_m) {
    return {rotation_from_vector({0.0, 0.0, number()}), {size_m * number(), size_m * number(), 0.0}};
  }

  /// Well conditioned, with every entry in use.
  Matrix6d information() {
    Matrix6d root;
    for (double& entry : root.reshaped()) entry = number();
    return root * root.transpose() + Matrix6d::Identity();
  }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

/// A chain of `num_vertices` random poses with `num_loops` random loops, measured with noise; `vertices` are the true poses.
inline PoseGraph random_graph(int dimension, std::size_t num_vertices, std::size_t num_loops, double sigma, std::uint32_t seed) {
  RandomPoses random(seed);
  std::mt19937 pick(seed);
  PoseGraph graph;
  graph.dimension = dimension;
  for (std::size_t v = 0; v < num_vertices; ++v) {
    graph.vertices.push_back({static_cast<std::int64_t>(v), dimension == 2 ? random.planar_pose(5.0) : random.pose(5.0), false});
  }
  const auto add = [&](std::size_t from, std::size_t to, EdgeKind kind) {
    Edge edge;
    edge.from = from;
    edge.to = to;
    edge.kind = kind;
    Pose noise = random.pose(sigma, sigma);
    if (dimension == 2)
      noise = {rotation_from_vector({0.0, 0.0, sigma * random.number()}), {noise.translation.x(), noise.translation.y(), 0.0}};
    edge.from_from_to = graph.vertices[from].world_from_frame.inverse() * graph.vertices[to].world_from_frame * noise;
    if (sigma > 0.0) edge.information /= sigma * sigma;
    graph.edges.push_back(edge);
  };
  for (std::size_t v = 1; v < num_vertices; ++v) add(v - 1, v, EdgeKind::Odometry);
  std::uniform_int_distribution<std::size_t> any(0, num_vertices - 1);
  while (graph.edges.size() < num_vertices - 1 + num_loops) {
    const std::size_t from = any(pick);
    const std::size_t to = any(pick);
    if (from != to) add(from, to, EdgeKind::Loop);
  }
  return graph;
}

/// A ring of `num_vertices` at one place whose steps say so, up to noise, and poses that turn once about z on the way round: a
/// local minimum, since every step is off by the same small angle.
inline PoseGraph wound_ring(int dimension, std::size_t num_vertices, double sigma, std::uint32_t seed) {
  RandomPoses random(seed);
  PoseGraph graph;
  graph.dimension = dimension;
  for (std::size_t v = 0; v < num_vertices; ++v) {
    const double yaw = 2.0 * kPi * static_cast<double>(v) / static_cast<double>(num_vertices);
    graph.vertices.push_back(
        {static_cast<std::int64_t>(v), {rotation_from_vector({0.0, 0.0, yaw}), Eigen::Vector3d::Zero()}, false});
    Edge edge;
    edge.from = v;
    edge.to = (v + 1) % num_vertices;
    edge.from_from_to = random.pose(sigma, sigma);
    if (dimension == 2)
      edge.from_from_to = Pose{rotation_from_vector({0.0, 0.0, sigma * random.number()}), Eigen::Vector3d::Zero()};
    graph.edges.push_back(edge);
  }
  return graph;
}

/// Forgets where everything but the anchors is.
inline void scatter(PoseGraph& graph, std::uint32_t seed) {
  RandomPoses random(seed);
  for (std::size_t v = 1; v < graph.vertices.size(); ++v) {
    if (graph.vertices[v].fixed) continue;
    graph.vertices[v].world_from_frame = graph.dimension == 2 ? random.planar_pose(50.0) : random.pose(50.0);
  }
}

}  // namespace fabloop::test
