// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/false_loop_study.h"

#include <ctime>
#include <string>
#include <utility>

#include "frontend/error.h"
#include "posegraph/evaluation/trajectory_error.h"

namespace fabloop {
namespace {

double share_of(std::size_t part, std::size_t whole) {
  return whole == 0 ? 1.0 : static_cast<double>(part) / static_cast<double>(whole);
}

Eigen::Matrix3Xd positions_of(const std::vector<Vertex>& vertices) {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(vertices.size()));
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    result.col(static_cast<Eigen::Index>(v)) = vertices[v].world_from_frame.translation;
  }
  return result;
}

/// ATE of vertices that correspond by their position.
double aligned_rmse(const std::vector<Vertex>& estimate, const std::vector<Vertex>& truth) {
  const Eigen::Matrix3Xd from = positions_of(estimate);
  const Eigen::Matrix3Xd to = positions_of(truth);
  const auto similarity = align_points(from, to, Alignment::Se3);
  if (!similarity) return 0.0;
  const Eigen::Matrix3Xd moved = (similarity->rotation.toRotationMatrix() * from).colwise() + similarity->translation;
  return std::sqrt((moved - to).colwise().squaredNorm().mean());
}

}  // namespace

double FalseLoopTrial::precision() const { return share_of(num_true_kept, num_true_kept + num_false_kept); }

double FalseLoopTrial::recall() const { return share_of(num_true_kept, num_true); }

FalseLoopTrial try_false_loops(PoseGraph graph, const std::vector<Vertex>& truth, const FalseLoopOptions& false_loops,
                               const RobustOptions& options) {
  if (truth.size() != graph.vertices.size()) {
    throw InputError("false loops: the truth has " + std::to_string(truth.size()) + " poses for " +
                     std::to_string(graph.vertices.size()) + " vertices; give one for each");
  }
  const std::size_t num_edges = graph.edges.size();
  const std::vector<Vertex> start = std::exchange(graph.vertices, truth);
  const std::vector<std::size_t> added = add_false_loops(graph, false_loops);
  graph.vertices = start;
  FalseLoopTrial trial;
  const std::clock_t begin = std::clock();
  trial.report = robust_optimize(graph, options);
  trial.cpu_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const EdgeVerdict verdict = trial.report.edges[e].verdict;
    if (verdict == EdgeVerdict::Trusted) continue;
    const bool is_kept = verdict == EdgeVerdict::Kept || verdict == EdgeVerdict::ForcedAccept;
    (e < num_edges ? trial.num_true : trial.num_false) += 1;
    (e < num_edges ? trial.num_true_kept : trial.num_false_kept) += is_kept;
  }
  trial.ate_m = aligned_rmse(graph.vertices, truth);
  return trial;
}

std::vector<Vertex> optimum_without_false_loops(PoseGraph graph, const OptimizeOptions& options) {
  optimize(graph, options);
  return std::move(graph.vertices);
}

}  // namespace fabloop
