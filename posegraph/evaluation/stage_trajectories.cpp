// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/evaluation/stage_trajectories.h"

#include <algorithm>
#include <optional>
#include <unordered_map>

#include "frontend/error.h"
#include "posegraph/evaluation/stage_evaluation.h"
#include "posegraph/optimize.h"

namespace fabloop {
namespace {

using PositionOfFrame = std::unordered_map<std::size_t, std::size_t>;

/// A proven loop that is not in the graph; its information is that of independent, equal errors of the stated size.
std::optional<Edge> edge_of(const LedgerTable& ledger, const LedgerRow& row, const PositionOfFrame& positions) {
  const auto from = positions.find(row.loop.match), to = positions.find(row.loop.query);
  const auto rotation_sigma_deg = ledger.figure(row, "rotation_sigma_deg"),
             translation_sigma = ledger.figure(row, "translation_sigma"),
             baseline_to_depth = ledger.figure(row, "baseline_to_depth");
  if (from == positions.end() || to == positions.end() || !row.loop.match_from_query) return std::nullopt;
  if (!(rotation_sigma_deg > 0.0) || !(translation_sigma > 0.0) || !(baseline_to_depth > 0.0)) return std::nullopt;
  Edge edge;
  edge.from = from->second;
  edge.to = to->second;
  edge.from_from_to = *row.loop.match_from_query;
  edge.kind = EdgeKind::Loop;
  edge.has_scale = row.loop.has_scale;
  const double length = edge.has_scale ? edge.from_from_to.translation.norm() : 1.0;
  const double sigma_m = *translation_sigma / *baseline_to_depth * length, sigma_rad = rad_from_deg(*rotation_sigma_deg);
  edge.information.setZero();
  edge.information.diagonal().head<3>().setConstant(1.0 / (sigma_m * sigma_m));
  edge.information.diagonal().tail<3>().setConstant(1.0 / (sigma_rad * sigma_rad));
  return edge;
}

StageTrajectory solve(PoseGraph graph, RobustLoss loss, const std::vector<std::int64_t>& times_ns) {
  optimize(graph, {.objective = Objective::RotationVector, .robust_loss = loss});
  StageTrajectory result;
  for (const Vertex& vertex : graph.vertices) {
    result.trajectory.push_back({times_ns.at(static_cast<std::size_t>(vertex.id)), vertex.world_from_frame});
  }
  for (const Edge& edge : graph.edges) result.num_loops += edge.kind == EdgeKind::Loop;
  return result;
}

}  // namespace

std::vector<StageTrajectory> solve_without_stages(const PoseGraph& graph, const LedgerTable& ledger,
                                                  const std::vector<std::int64_t>& times_ns) {
  PositionOfFrame positions;
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
    const std::int64_t id = graph.vertices[i].id;
    if (id < 0 || static_cast<std::size_t>(id) >= times_ns.size()) {
      throw InputError("graph.g2o: vertex " + std::to_string(id) + " is no frame of frames.csv; are they of one run?");
    }
    positions[static_cast<std::size_t>(id)] = i;
  }
  PoseGraph without_loops = graph;
  std::erase_if(without_loops.edges, [](const Edge& edge) { return edge.kind == EdgeKind::Loop; });
  PoseGraph proven = graph;
  constexpr int kProven = 3;
  for (const LedgerRow& row : ledger.rows) {
    if (num_stages_passed(row.loop.verdict) < kProven || row.loop.accepted()) continue;
    if (auto edge = edge_of(ledger, row, positions)) proven.edges.push_back(*edge);
  }
  std::vector<StageTrajectory> results = {solve(without_loops, RobustLoss::None, times_ns),
                                          solve(proven, RobustLoss::None, times_ns),
                                          solve(std::move(proven), RobustLoss::Cauchy, times_ns)};
  results[0].name = "without loops";
  results[0].note = "odometry and links between neighbours alone";
  results[1].name = "without back end";
  results[1].note = "all proven loops, each believed fully: least squares";
  results[2].name = "without withdrawal";
  results[2].note = "all proven loops under the Cauchy loss";
  return results;
}

}  // namespace fabloop
