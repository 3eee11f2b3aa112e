// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <ostream>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "frontend/output_file.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/g2o/g2o_line.h"

namespace fabloop {
namespace {

using namespace g2o;

/// roll, pitch, yaw with R = Rz(yaw) Ry(pitch) Rx(roll).
Eigen::Vector3d roll_pitch_yaw(const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d r = rotation.toRotationMatrix();
  const double yaw = std::atan2(r(1, 0), r(0, 0));
  const double pitch = std::atan2(-r(2, 0), std::hypot(r(2, 1), r(2, 2)));
  // Of the rotation without yaw, so that straight up and down, where yaw and roll are one, comes out right too.
  const Eigen::Matrix3d rest = Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitZ()) * r;
  return {std::atan2(-rest(1, 2), rest(1, 1)), pitch, yaw};
}

void write_toro_pose(std::ostream& out, const Pose& pose, int dimension) {
  const auto& [q, t] = pose;
  const Eigen::Vector3d angles = roll_pitch_yaw(q);
  if (dimension == 2) {
    for (const double value : {t.x(), t.y(), std::remainder(2.0 * std::atan2(q.z(), q.w()), 2.0 * kPi)}) write_number(out, value);
  } else {
    for (const double value : {t.x(), t.y(), t.z(), angles.x(), angles.y(), angles.z()}) write_number(out, value);
  }
}

void write_toro_information(std::ostream& out, const Matrix6d& information, int dimension) {
  if (dimension == 2) {
    constexpr std::array<std::pair<int, int>, 6> kEntries = {{{0, 0}, {0, 1}, {1, 1}, {5, 5}, {0, 5}, {1, 5}}};
    for (const auto& [row, column] : kEntries) write_number(out, information(row, column));
    return;
  }
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) write_number(out, information(row, column));
  }
}

void check_for_toro(const std::filesystem::path& path, const PoseGraph& graph) {
  check(graph);
  if (!graph.priors.empty()) throw InputError(path.string() + ": TORO has no priors; write a .g2o file");
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    if (graph.edges[e].has_scale) continue;
    throw InputError(path.string() + ": edge " + std::to_string(e) +
                     " (counted from 0) has no scale, which TORO does not know; write a .g2o file");
  }
}

}  // namespace

void write_toro(const std::filesystem::path& path, const PoseGraph& graph) {
  check_for_toro(path, graph);
  OutputFile file(path);
  std::ostream& out = file.stream();
  for (const Vertex& vertex : graph.vertices) {
    out << "VERTEX" << graph.dimension << ' ' << vertex.id;
    write_toro_pose(out, vertex.world_from_frame, graph.dimension);
    out << '\n';
  }
  for (const Vertex& vertex : graph.vertices) {
    if (vertex.fixed) out << "FIX " << vertex.id << '\n';
  }
  for (const Edge& edge : graph.edges) {
    const std::int64_t from_id = graph.vertices[edge.from].id;
    const std::int64_t to_id = graph.vertices[edge.to].id;
    if (edge.kind != usual_kind(from_id, to_id)) out << kind_comment(edge.kind);
    out << "EDGE" << graph.dimension << ' ' << from_id << ' ' << to_id;
    write_toro_pose(out, edge.from_from_to, graph.dimension);
    write_toro_information(out, edge.information, graph.dimension);
    out << '\n';
  }
  file.commit();
}

}  // namespace fabloop
