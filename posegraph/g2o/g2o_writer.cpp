// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>

#include "frontend/output_file.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/g2o/g2o_line.h"

namespace fabloop {
namespace {

using namespace g2o;

void write_pose(std::ostream& out, const Pose& pose, int dimension) {
  const auto& [q, t] = pose;
  if (dimension == 2) {
    const double yaw = std::remainder(2.0 * std::atan2(q.z(), q.w()), 2.0 * kPi);
    for (const double value : {t.x(), t.y(), yaw}) write_number(out, value);
    return;
  }
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) write_number(out, value);
}

void write_information(std::ostream& out, const Matrix6d& information, int dimension) {
  constexpr std::array<int, 3> kPlanarRows = {0, 1, 5};
  const int size = dimension == 3 ? 6 : 3;
  for (int i = 0; i < size; ++i) {
    for (int j = i; j < size; ++j) {
      write_number(out, dimension == 3 ? information(i, j) : information(kPlanarRows[i], kPlanarRows[j]));
    }
  }
}

void write_triangle(std::ostream& out, const Matrix6d& information, int first, int size) {
  for (int i = first; i < first + size; ++i) {
    for (int j = i; j < first + size; ++j) write_number(out, information(i, j));
  }
}

void write_prior(std::ostream& out, const PoseGraph& graph, const VertexPrior& prior) {
  const int d = graph.dimension;
  const auto& [q, t] = prior.world_from_frame;
  const std::int64_t id = graph.vertices[prior.vertex].id;
  switch (prior.kind) {
    case PriorKind::Pose:
      // g2o wants the id of an offset; a file with such priors defines offset 0, the identity.
      out << (d == 2 ? "EDGE_PRIOR_SE2 " : "EDGE_SE3_PRIOR ") << id << (d == 2 ? "" : " 0");
      write_pose(out, prior.world_from_frame, d);
      write_information(out, prior.information, d);
      break;
    case PriorKind::Position:
      out << (d == 2 ? "EDGE_PRIOR_SE2_XY " : "EDGE_SE3_POSITION_PRIOR ") << id;
      for (int k = 0; k < d; ++k) write_number(out, t(k));
      write_triangle(out, prior.information, 0, d);
      break;
    case PriorKind::Attitude:
      out << "EDGE_SE3_ATTITUDE_PRIOR " << id;
      for (const double value : {q.x(), q.y(), q.z(), q.w()}) write_number(out, value);
      write_triangle(out, prior.information, 3, 3);
      break;
  }
  out << '\n';
}

bool has_unusual_kind(const PoseGraph& graph, const Edge& edge) {
  return edge.kind != usual_kind(graph.vertices[edge.from].id, graph.vertices[edge.to].id);
}

/// Some readers stop at comments, so there is one only where the file says what others do not know.
void write_header(std::ostream& out, const PoseGraph& graph) {
  const auto has_direction = [](const Edge& edge) { return !edge.has_scale; };
  const auto is_ours = [&](const VertexPrior& prior) { return prior.kind != PriorKind::Pose && graph.dimension == 3; };
  if (std::any_of(graph.priors.begin(), graph.priors.end(), is_ours)) {
    out << "# EDGE_SE3_POSITION_PRIOR: id, x y z in the world, 6 upper-triangular information entries. EDGE_SE3_ATTITUDE_PRIOR:\n"
           "# id, qx qy qz qw of world_from_frame, of which roll and pitch count, 6 entries. Other programs skip them.\n";
  }
  const auto is_unusual = [&](const Edge& edge) { return has_unusual_kind(graph, edge); };
  if (std::any_of(graph.edges.begin(), graph.edges.end(), has_direction)) {
    out << "# EDGE_SE3_DIRECTION:QUAT has the columns of EDGE_SE3:QUAT, but its translation is a unit direction: the distance "
           "is\n"
           "# not known. The translation part of its information weighs the error of that direction. Other programs skip it.\n";
  }
  if (std::any_of(graph.edges.begin(), graph.edges.end(), is_unusual)) out << kKindExplanation;
}

}  // namespace

void write_g2o(const std::filesystem::path& path, const PoseGraph& graph) {
  check(graph);
  OutputFile file(path);
  std::ostream& out = file.stream();
  write_header(out, graph);
  const auto wants_offset = [&](const VertexPrior& prior) { return prior.kind == PriorKind::Pose && graph.dimension == 3; };
  if (std::any_of(graph.priors.begin(), graph.priors.end(), wants_offset)) out << "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\n";
  for (const Vertex& vertex : graph.vertices) {
    out << (graph.dimension == 2 ? "VERTEX_SE2 " : "VERTEX_SE3:QUAT ") << vertex.id;
    write_pose(out, vertex.world_from_frame, graph.dimension);
    out << '\n';
  }
  for (const Vertex& vertex : graph.vertices) {
    if (vertex.fixed) out << "FIX " << vertex.id << '\n';
  }
  for (const Edge& edge : graph.edges) {
    if (has_unusual_kind(graph, edge)) out << kind_comment(edge.kind);
    out << (graph.dimension == 2 ? "EDGE_SE2 " : edge.has_scale ? "EDGE_SE3:QUAT " : "EDGE_SE3_DIRECTION:QUAT ");
    out << graph.vertices[edge.from].id << ' ' << graph.vertices[edge.to].id;
    write_pose(out, edge.from_from_to, graph.dimension);
    write_information(out, edge.information, graph.dimension);
    out << '\n';
  }
  for (const VertexPrior& prior : graph.priors) write_prior(out, graph, prior);
  file.commit();
}

}  // namespace fabloop
