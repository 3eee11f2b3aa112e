// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "posegraph/connectivity.h"
#include "posegraph/pose_graph.h"

namespace fabloop::test {

/// A small rotation about an arbitrary axis, given as a rotation vector [rad].
inline Eigen::Quaterniond rotation_from_vector(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle == 0.0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, vector / angle));
}

/// A pose that only shifts [m].
inline Pose shift(double x, double y, double z) { return {Eigen::Quaterniond::Identity(), {x, y, z}}; }

struct CircleOptions {
  int num_vertices = 40;
  double radius_m = 10.0;
  double sigma_translation_m = 0.0;
  double sigma_rotation_rad = 0.0;
  std::uint32_t seed = 1;
  int dimension = 3;
  bool climbs = true;  ///< A slight spiral with pitch, so that all axes matter.
};

/// The true poses on a circle (two laps, so that loops join the laps) and noisy edges: odometry, and a loop every fifth vertex.
/// The vertices are chained from the noisy odometry; `truth` is where they should be.
struct Circle {
  PoseGraph graph;
  PoseGraph truth;
};

inline Edge measured_edge(const PoseGraph& truth, std::size_t from, std::size_t to, EdgeKind kind) {
  Edge edge;
  edge.from = from;
  edge.to = to;
  edge.kind = kind;
  edge.from_from_to = truth.vertices[from].world_from_frame.inverse() * truth.vertices[to].world_from_frame;
  return edge;
}

inline Circle make_circle(const CircleOptions& options = {}) {
  Circle circle;
  std::mt19937 random(options.seed);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    return Eigen::Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random));
  };
  const int lap = options.num_vertices / 2;
  const bool planar = options.dimension == 2;
  circle.truth.dimension = options.dimension;
  for (int k = 0; k < options.num_vertices; ++k) {
    const double angle = 2.0 * kPi * k / lap;
    const double z = planar || !options.climbs ? 0.0 : 0.1 * k;
    Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
              {options.radius_m * std::cos(angle), options.radius_m * std::sin(angle), z}};
    if (!planar && options.climbs) pose.rotation = pose.rotation * rotation_from_vector({0.2 * std::sin(angle), 0.3, 0.1});
    circle.truth.vertices.push_back({k, pose, false});
  }
  const auto add = [&](int from, int to, EdgeKind kind) {
    Edge edge = measured_edge(circle.truth, static_cast<std::size_t>(from), static_cast<std::size_t>(to), kind);
    Eigen::Vector3d translation_noise = noise(options.sigma_translation_m);
    Eigen::Vector3d rotation_noise = noise(options.sigma_rotation_rad);
    if (planar) {
      translation_noise.z() = 0.0;
      rotation_noise.head<2>().setZero();
    }
    edge.from_from_to = edge.from_from_to * Pose{rotation_from_vector(rotation_noise), translation_noise};
    if (options.sigma_translation_m > 0.0) edge.information.topLeftCorner<3, 3>() /= std::pow(options.sigma_translation_m, 2);
    if (options.sigma_rotation_rad > 0.0) edge.information.bottomRightCorner<3, 3>() /= std::pow(options.sigma_rotation_rad, 2);
    circle.truth.edges.push_back(edge);
  };
  for (int k = 1; k < options.num_vertices; ++k) add(k - 1, k, EdgeKind::Odometry);
  for (int k = 0; k + lap < options.num_vertices; k += 5) add(k, k + lap, EdgeKind::Loop);
  circle.graph = circle.truth;
  // Loops join what odometry reached already only where odometry comes first, so chain without them.
  PoseGraph chain = circle.truth;
  chain.edges.resize(static_cast<std::size_t>(options.num_vertices) - 1);
  chain_along_edges(chain);
  circle.graph.vertices = chain.vertices;
  return circle;
}

/// Largest distance between the vertices of two graphs [m].
inline double largest_distance(const PoseGraph& a, const PoseGraph& b) {
  double largest = 0.0;
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    largest = std::max(largest, (a.vertices[v].world_from_frame.translation - b.vertices[v].world_from_frame.translation).norm());
  }
  return largest;
}

/// Largest angle between the vertices of two graphs [rad].
inline double largest_angle(const PoseGraph& a, const PoseGraph& b) {
  double largest = 0.0;
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    const auto& rotation_a = a.vertices[v].world_from_frame.rotation;
    largest = std::max(largest, rotation_angle(rotation_a.conjugate() * b.vertices[v].world_from_frame.rotation));
  }
  return largest;
}

}  // namespace fabloop::test
