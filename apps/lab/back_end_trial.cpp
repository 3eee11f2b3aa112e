// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/back_end_trial.h"

#include <algorithm>
#include <utility>

#include "posegraph/evaluation/trajectory_error.h"
#include "posegraph/loop_withdrawal.h"
#include "posegraph/robust/false_loops.h"
#include "posegraph/robust/robust_optimize.h"
#include "posegraph/robust/session_alignment.h"
#include "verification/verdict.h"

namespace fabloop {
namespace {

/// Returns the edges' positions.
std::vector<std::size_t> inject_false_loops(PoseGraph& graph, const LabSettings& settings) {
  const bool has_loops =
      std::any_of(graph.edges.begin(), graph.edges.end(), [](const Edge& edge) { return edge.kind == EdgeKind::Loop; });
  const double share = settings.random_false_loops + settings.grouped_false_loops;
  if (!has_loops || share == 0.0) return {};
  FalseLoopOptions options;
  options.pattern = settings.grouped_false_loops > 0.0 ? FalseLoopPattern::Groups : FalseLoopPattern::Random;
  options.share = share;
  options.group_size = static_cast<std::size_t>(settings.false_loop_group_size);
  options.seed = settings.trouble.seed;
  return add_false_loops(graph, options);
}

/// As Mapper::finish(): solves under the mapper's loss, leaves out what contradicts the map, and solves again. Which edges stay.
std::vector<bool> withdraw_as_mapper(PoseGraph& graph, const MapperOptions& options) {
  const OptimizeReport report = optimize(graph, options.optimize);
  std::vector<bool> is_kept(graph.edges.size(), true);
  PoseGraph rest = graph;
  rest.edges.clear();
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    is_kept[e] = !contradicts_map(graph.edges[e], report.edges[e].chi2, options.max_loop_surprise);
    if (is_kept[e]) rest.edges.push_back(graph.edges[e]);
  }
  if (rest.edges.size() < graph.edges.size()) optimize(rest, options.optimize);
  graph.vertices = std::move(rest.vertices);
  return is_kept;
}

std::vector<bool> decide(PoseGraph& graph, const LabBackEnd& back_end, const BackEndProblem& problem) {
  if (!back_end.back_end) return withdraw_as_mapper(graph, problem.mapper);
  RobustOptions options;
  options.back_end = *back_end.back_end;
  options.inlier_probability = problem.settings.inlier_probability;
  options.optimize.objective = problem.mapper.optimize.objective;
  const RobustReport report = robust_optimize(graph, options);
  std::vector<bool> is_kept;
  for (const EdgeDecision& edge : report.edges)
    is_kept.push_back(edge.verdict != EdgeVerdict::Rejected && edge.verdict != EdgeVerdict::ForcedReject);
  return is_kept;
}

TriedLoop tried(const PoseGraph& graph, const Edge& edge, bool is_injected, const BackEndProblem& problem) {
  TriedLoop loop;
  loop.match = static_cast<std::size_t>(graph.vertices[edge.from].id);
  loop.query = static_cast<std::size_t>(graph.vertices[edge.to].id);
  loop.is_injected = is_injected;
  if (!is_injected) return loop;
  const LoopRecord record{loop.query, loop.match, std::string(to_string(Verdict::Accepted)), edge.has_scale, edge.from_from_to};
  const bool is_right = judge_loop(record, problem.truth, problem.evaluation).judgement == LoopJudgement::True;
  loop.truth = is_right ? MatchTruth::True : MatchTruth::False;
  return loop;
}

Trajectory trajectory_of(const PoseGraph& graph, const std::vector<std::int64_t>& times_ns) {
  Trajectory trajectory;
  for (const Vertex& vertex : graph.vertices)
    trajectory.push_back({times_ns.at(static_cast<std::size_t>(vertex.id)), vertex.world_from_frame});
  return trajectory;
}

}  // namespace

std::optional<double> ate_of(const Trajectory& estimate, const Trajectory& reference) {
  const auto ate = absolute_trajectory_error(estimate, reference);
  return ate ? std::optional(ate->translation_m.rmse) : std::nullopt;
}

// A neighbour's translation has unit length: it says where to, not how far.
void start_from_odometry(PoseGraph& graph) { chain_sessions(graph, {EdgeKind::Loop, EdgeKind::Neighbour}); }

std::vector<BackEndTrial> try_back_ends(const std::vector<LabBackEnd>& back_ends, const BackEndProblem& problem) {
  PoseGraph graph = problem.map.graph;
  const std::vector<std::size_t> injected = inject_false_loops(graph, problem.settings);
  const std::size_t num_own = graph.edges.size() - injected.size();
  start_from_odometry(graph);
  std::vector<BackEndTrial> trials;
  for (const LabBackEnd& back_end : back_ends) {
    PoseGraph solved = graph;
    const std::vector<bool> is_kept = decide(solved, back_end, problem);
    BackEndTrial trial;
    trial.name = back_end.name;
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
      if (graph.edges[e].kind != EdgeKind::Loop) continue;
      trial.loops.push_back(tried(graph, graph.edges[e], e >= num_own, problem));
      trial.loops.back().is_kept = is_kept[e];
    }
    trial.ate_m = ate_of(trajectory_of(solved, problem.frame_times_ns), problem.reference);
    trials.push_back(std::move(trial));
  }
  return trials;
}

}  // namespace fabloop
