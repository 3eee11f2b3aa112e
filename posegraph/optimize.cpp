// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/optimize.h"

#include <ceres/manifold.h>
#include <ceres/problem.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "frontend/error.h"
#include "posegraph/connectivity.h"
#include "posegraph/information.h"
#include "posegraph/residuals/graph_costs.h"
#include "posegraph/residuals/sparse_solver.h"
#include "posegraph/residuals/yaw_manifold.h"
#include "posegraph/robust/session_alignment.h"
#include "posegraph/solver_state.h"

namespace fabloop {
namespace {

void check(const PoseGraph& graph, const OptimizeOptions& options) {
  check(graph);
  if (!(options.robust_probability > 0.0 && options.robust_probability < 1.0)) {
    throw InputError("robust probability must be between 0 and 1, both excluded");
  }
  if (options.freedom == Freedom::YawAndPosition && options.initialization != Initialization::AsGiven) {
    throw InputError("yaw and position only: roll and pitch are those of the poses given, so start from them");
  }
}

/// The anchors, less those of components that priors place: what priors leave open stays near where it is.
std::vector<std::size_t> find_held(const PoseGraph& graph, const Components& components) {
  std::vector<bool> has_prior(components.count, false);
  for (const VertexPrior& prior : graph.priors) has_prior[components.of_vertex[prior.vertex]] = true;
  std::vector<std::size_t> held = find_anchors(graph, components);
  std::erase_if(held, [&](std::size_t v) { return !graph.vertices[v].fixed && has_prior[components.of_vertex[v]]; });
  return held;
}

/// Components, anchors and mended matrices.
OptimizeReport describe(const PoseGraph& graph, Objective objective) {
  OptimizeReport report;
  const Components components = connected_components(graph);
  report.anchors = find_held(graph, components);
  std::vector<bool> has_scale(components.count, false);
  std::vector<bool> has_edge(components.count, false);
  for (const Edge& edge : graph.edges) {
    const std::size_t component = components.of_vertex[edge.from];
    has_edge[component] = true;
    if (edge.has_scale) has_scale[component] = true;
    // The chordal objective reads traces only, which need no mending.
    if (objective != Objective::Chordal && !is_positive_semidefinite(edge.information)) ++report.num_mended_information;
  }
  report.num_components = components.count;
  for (std::size_t c = 0; c < components.count; ++c) report.num_components_without_scale += has_edge[c] && !has_scale[c];
  return report;
}

/// What Ceres points into; it must outlive the problem.
struct Solver {
  ceres::EigenQuaternionManifold quaternion;
  residuals::YawManifold yaw;
  std::vector<std::unique_ptr<residuals::Loss>> losses;
};

void add_vertices(const PoseGraph& graph, const OptimizeReport& report, const OptimizeOptions& options,
                  std::vector<State>& states, Solver& solver, ceres::Problem& problem) {
  ceres::Manifold* const rotations =
      options.freedom == Freedom::YawAndPosition ? static_cast<ceres::Manifold*>(&solver.yaw) : &solver.quaternion;
  for (State& state : states) {
    if (graph.dimension == 2) {
      problem.AddParameterBlock(state.data(), 3);
    } else {
      problem.AddParameterBlock(state.data(), 4, rotations);
      problem.AddParameterBlock(state.data() + 4, 3);
    }
  }
  for (const std::size_t v : report.anchors) {
    problem.SetParameterBlockConstant(states[v].data());
    if (graph.dimension == 3) problem.SetParameterBlockConstant(states[v].data() + 4);
  }
}

void add_costs(const PoseGraph& graph, const GraphCosts& costs, std::vector<State>& states, Solver& solver,
               ceres::Problem& problem) {
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const EdgeLoss loss = costs.losses()[e];
    if (loss.loss != RobustLoss::None) solver.losses.push_back(std::make_unique<residuals::Loss>(loss.loss, loss.c2));
    problem.AddResidualBlock(costs.edge_residuals()[e].get(),
                             loss.loss == RobustLoss::None ? nullptr : solver.losses.back().get(),
                             blocks_of(graph.edges[e], graph.dimension, states));
  }
  for (std::size_t p = 0; p < graph.priors.size(); ++p) {
    problem.AddResidualBlock(costs.prior_residuals()[p].get(), nullptr, costs.blocks_of_prior(graph.priors[p], states));
  }
  for (double* const block : costs.world_blocks()) problem.SetParameterBlockConstant(block);
}

/// Puts the graph at one start.
void initialize(PoseGraph& graph, Initialization initialization, const OptimizeOptions& options) {
  if (initialization == Initialization::SpanningTree) chain_along_edges(graph);
  if (initialization == Initialization::Sessions) {
    chain_sessions(graph, options.robust_kinds);
    align_sessions(graph, {options.robust_kinds, options.robust_probability});
  }
  if (initialization == Initialization::Chordal) initialize_chordal(graph);
  if (initialization != Initialization::AsGiven) move_to_priors(graph);
}

/// Puts the graph at its start and says which one that is; `given_cost` is that of the poses given.
Initialization choose_start(PoseGraph& graph, const GraphCosts& costs, double given_cost, const OptimizeOptions& options) {
  if (options.initialization != Initialization::LowestCost) {
    initialize(graph, options.initialization, options);
    return options.initialization;
  }
  Initialization best = Initialization::AsGiven;
  double lowest_cost = given_cost;
  const PoseGraph given = graph;
  for (const Initialization candidate : {Initialization::SpanningTree, Initialization::Chordal, Initialization::Sessions}) {
    if (candidate == Initialization::Sessions && num_sessions(given, options.robust_kinds) == 1) continue;
    PoseGraph start = given;
    initialize(start, candidate, options);
    std::vector<State> states = read_states(start);
    const double cost = costs.sum(costs.evaluate_edges(states), costs.evaluate_priors(states));
    if (cost >= lowest_cost) continue;
    best = candidate;
    lowest_cost = cost;
    graph.vertices = std::move(start.vertices);
  }
  return best;
}

/// Lets Ceres move the states.
void solve(const PoseGraph& graph, const GraphCosts& costs, const OptimizeOptions& options, std::vector<State>& states,
           OptimizeReport& report) {
  Solver solver;
  ceres::Problem problem(residuals::unowned());
  add_vertices(graph, report, options, states, solver, problem);
  add_costs(graph, costs, states, solver, problem);
  const residuals::SolverRun run = residuals::run(options, report.start, problem);
  report.termination = run.termination;
  report.iterations = run.iterations;
}

}  // namespace

OptimizeReport optimize(PoseGraph& graph, const OptimizeOptions& options) {
  check(graph, options);
  OptimizeReport report = describe(graph, options.objective);
  const GraphCosts costs(graph, options);
  std::vector<State> states = read_states(graph);
  const auto judge = [&] {
    report.edges = costs.evaluate_edges(states);
    report.priors = costs.evaluate_priors(states);
    return costs.sum(report.edges, report.priors);
  };
  report.initial_cost = report.final_cost = judge();
  const bool says_nothing = graph.edges.empty() && graph.priors.empty();
  if (says_nothing || report.anchors.size() == graph.vertices.size()) return report;

  const std::vector<Vertex> given = graph.vertices;
  report.start = choose_start(graph, costs, report.initial_cost, options);
  states = read_states(graph);
  solve(graph, costs, options, states, report);
  if (report.termination == Termination::Failed) {
    graph.vertices = given;
    return report;
  }
  for (std::size_t v = 0, next_anchor = 0; v < states.size(); ++v) {
    if (next_anchor < report.anchors.size() && report.anchors[next_anchor] == v) {
      ++next_anchor;
    } else {
      graph.vertices[v].world_from_frame = pose_from_state(states[v], graph.dimension);
    }
  }
  states = read_states(graph);
  report.final_cost = judge();
  return report;
}

std::vector<EdgeResult> evaluate_edges(const PoseGraph& graph, const OptimizeOptions& options) {
  check(graph, options);
  std::vector<State> states = read_states(graph);
  return GraphCosts(graph, options).evaluate_edges(states);
}

double evaluate_cost(const PoseGraph& graph, const OptimizeOptions& options) {
  check(graph, options);
  std::vector<State> states = read_states(graph);
  const GraphCosts costs(graph, options);
  return costs.sum(costs.evaluate_edges(states), costs.evaluate_priors(states));
}

}  // namespace fabloop
