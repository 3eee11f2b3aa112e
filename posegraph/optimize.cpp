// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/optimize.h"

#include <ceres/iteration_callback.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "frontend/error.h"
#include "posegraph/connectivity.h"
#include "posegraph/information.h"
#include "posegraph/residuals/residuals.h"
#include "posegraph/solver_state.h"
#include "verification/chi_square.h"

namespace fabloop {
namespace {

/// A robust loss in Ceres' clothes.
class Loss final : public ceres::LossFunction {
 public:
  Loss(RobustLoss loss, double c2) : loss_(loss), c2_(c2) {}
  void Evaluate(double s, double rho[3]) const override {
    rho[0] = robust_cost(loss_, s, c2_);
    rho[1] = robust_weight(loss_, s, c2_);
    rho[2] = robust_curvature(loss_, s, c2_);
  }

 private:
  RobustLoss loss_;
  double c2_;
};

/// Which loss an edge has, and the square of its scale.
struct EdgeLoss {
  RobustLoss loss = RobustLoss::None;
  double c2 = 1.0;
};

std::vector<EdgeLoss> edge_losses(const PoseGraph& graph, const OptimizeOptions& options) {
  // Of 5 and 6 errors in space, 3 in the plane.
  std::array<double, residuals::kMaxSize + 1> c2{};
  for (const int degrees_of_freedom : {3, 5, 6}) {
    c2[degrees_of_freedom] = chi_square_quantile(options.robust_probability, degrees_of_freedom);
  }
  std::vector<EdgeLoss> losses;
  losses.reserve(graph.edges.size());
  for (const Edge& edge : graph.edges) {
    const auto& kinds = options.robust_kinds;
    const bool is_robust = std::find(kinds.begin(), kinds.end(), edge.kind) != kinds.end();
    losses.push_back(is_robust ? EdgeLoss{options.robust_loss, c2[graph.dimension == 2 ? 3
                                                                  : edge.has_scale     ? 6
                                                                                       : 5]}
                               : EdgeLoss{});
  }
  return losses;
}

/// Progress, cancelling, and when to stop. The cost falls by a factor of about `ratio` less with each iteration, so what is left
/// to gain is the geometric series that goes on from the last two: one iteration less than waiting for one without gain.
class IterationControl final : public ceres::IterationCallback {
 public:
  explicit IterationControl(const OptimizeOptions& options) : options_(options) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (options_.progress) {
      options_.progress("optimize", static_cast<std::size_t>(summary.iteration),
                        static_cast<std::size_t>(options_.max_iterations));
    }
    cancelled = options_.cancelled && options_.cancelled();
    // "Successfully" makes Ceres hand back the best poses so far.
    return cancelled || has_converged(summary) ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

  bool cancelled = false;

 private:
  bool has_converged(const ceres::IterationSummary& summary) {
    if (!summary.step_is_successful) {
      last_change_ = 0.0;
      return false;
    }
    const double change = std::exchange(last_change_, summary.cost_change);
    // A slow series may hide a slower one.
    constexpr double kMaxRatio = 0.1;
    const double ratio = change > 0.0 ? summary.cost_change / change : 1.0;
    return ratio <= kMaxRatio && summary.cost_change * ratio / (1.0 - ratio) <= options_.cost_tolerance * summary.cost;
  }

  const OptimizeOptions& options_;
  double last_change_ = 0.0;
};

void check(const PoseGraph& graph, const OptimizeOptions& options) {
  check(graph);
  if (!(options.robust_probability > 0.0 && options.robust_probability < 1.0)) {
    throw InputError("robust probability must be between 0 and 1, both excluded");
  }
}

/// Components, anchors and mended matrices.
OptimizeReport describe(const PoseGraph& graph, Objective objective) {
  OptimizeReport report;
  const Components components = connected_components(graph);
  report.anchors = find_anchors(graph, components);
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

using Residuals = std::vector<std::unique_ptr<ceres::CostFunction>>;

Residuals make_residuals(const PoseGraph& graph, Objective objective) {
  Residuals residuals;
  residuals.reserve(graph.edges.size());
  for (const Edge& edge : graph.edges) residuals.push_back(residuals::make_residual(edge, graph.dimension, objective));
  return residuals;
}

std::vector<EdgeResult> evaluate_edges(const PoseGraph& graph, const Residuals& residuals, std::vector<State>& states,
                                       const std::vector<EdgeLoss>& losses) {
  std::vector<EdgeResult> results;
  results.reserve(graph.edges.size());
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const Edge& edge = graph.edges[e];
    std::array<double, residuals::kMaxSize> residual{};
    residuals[e]->Evaluate(blocks_of(edge, graph.dimension, states).data(), residual.data(), nullptr);
    double chi2 = 0.0;
    for (const double r : residual) chi2 += r * r;
    results.push_back({chi2, robust_weight(losses[e].loss, chi2, losses[e].c2)});
  }
  return results;
}

double sum_cost(const std::vector<EdgeResult>& results, const std::vector<EdgeLoss>& losses) {
  double cost = 0.0;
  for (std::size_t e = 0; e < results.size(); ++e) cost += robust_cost(losses[e].loss, results[e].chi2, losses[e].c2);
  return cost;
}

/// What Ceres points into; it must outlive the problem.
struct Solver {
  ceres::EigenQuaternionManifold quaternion;
  std::vector<std::unique_ptr<Loss>> losses;
};

ceres::Problem::Options unowned() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

void build(const PoseGraph& graph, const Residuals& residuals, const std::vector<std::size_t>& anchors,
           const std::vector<EdgeLoss>& losses, std::vector<State>& states, Solver& solver, ceres::Problem& problem) {
  for (State& state : states) {
    if (graph.dimension == 2) {
      problem.AddParameterBlock(state.data(), 3);
    } else {
      problem.AddParameterBlock(state.data(), 4, &solver.quaternion);
      problem.AddParameterBlock(state.data() + 4, 3);
    }
  }
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const EdgeLoss loss = losses[e];
    if (loss.loss != RobustLoss::None) solver.losses.push_back(std::make_unique<Loss>(loss.loss, loss.c2));
    problem.AddResidualBlock(residuals[e].get(), loss.loss == RobustLoss::None ? nullptr : solver.losses.back().get(),
                             blocks_of(graph.edges[e], graph.dimension, states));
  }
  for (const std::size_t v : anchors) {
    problem.SetParameterBlockConstant(states[v].data());
    if (graph.dimension == 3) problem.SetParameterBlockConstant(states[v].data() + 4);
  }
}

ceres::Solver::Options solver_options(const OptimizeOptions& options, Initialization start) {
  ceres::Solver::Options result;
  result.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  result.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  // Sums over threads would come out in another order each time.
  result.num_threads = 1;
  result.max_num_iterations = options.max_iterations;
  result.function_tolerance = options.cost_tolerance;
  result.gradient_tolerance = 0.0;
  result.parameter_tolerance = 1e-14;
  result.logging_type = ceres::SILENT;
  // Near the optimum damping only holds up the bends that are as long as the map: take Gauss-Newton steps first.
  constexpr double kHardlyDamped = 1e10;
  if (start == Initialization::Chordal) result.initial_trust_region_radius = kHardlyDamped;
  return result;
}

Termination termination_of(const ceres::Solver::Summary& summary, bool cancelled) {
  if (cancelled) return Termination::Cancelled;
  const bool stopped = summary.termination_type == ceres::USER_SUCCESS;
  if (stopped || summary.termination_type == ceres::CONVERGENCE) return Termination::Converged;
  if (summary.termination_type == ceres::NO_CONVERGENCE) return Termination::MaxIterations;
  return Termination::Failed;
}

/// Puts the graph at its start and says which one that is.
Initialization initialize(PoseGraph& graph, const OptimizeOptions& options) {
  switch (options.initialization) {
    case Initialization::AsGiven:
      break;
    case Initialization::SpanningTree:
      chain_along_edges(graph);
      break;
    case Initialization::Chordal:
      initialize_chordal(graph);
      break;
    case Initialization::LowestCost: {
      Initialization best = Initialization::AsGiven;
      double lowest_cost = evaluate_cost(graph, options);
      const PoseGraph given = graph;
      for (const Initialization candidate : {Initialization::SpanningTree, Initialization::Chordal}) {
        PoseGraph start = given;
        candidate == Initialization::Chordal ? initialize_chordal(start) : chain_along_edges(start);
        const double cost = evaluate_cost(start, options);
        if (cost >= lowest_cost) continue;
        best = candidate;
        lowest_cost = cost;
        graph.vertices = std::move(start.vertices);
      }
      return best;
    }
  }
  return options.initialization;
}

/// Lets Ceres move the states.
void solve(const PoseGraph& graph, const Residuals& residuals, const std::vector<EdgeLoss>& losses,
           const OptimizeOptions& options, std::vector<State>& states, OptimizeReport& report) {
  Solver solver;
  ceres::Problem problem(unowned());
  build(graph, residuals, report.anchors, losses, states, solver, problem);
  ceres::Solver::Options ceres_options = solver_options(options, report.start);
  IterationControl control(options);
  ceres_options.callbacks.push_back(&control);
  ceres::Solver::Summary summary;
  ceres::Solve(ceres_options, &problem, &summary);
  report.termination = termination_of(summary, control.cancelled);
  report.iterations = summary.num_successful_steps + summary.num_unsuccessful_steps - 1;
}

}  // namespace

OptimizeReport optimize(PoseGraph& graph, const OptimizeOptions& options) {
  check(graph, options);
  OptimizeReport report = describe(graph, options.objective);
  const Residuals residuals = make_residuals(graph, options.objective);
  const std::vector<EdgeLoss> losses = edge_losses(graph, options);
  std::vector<State> states = read_states(graph);
  report.edges = evaluate_edges(graph, residuals, states, losses);
  report.initial_cost = report.final_cost = sum_cost(report.edges, losses);
  if (graph.edges.empty() || report.anchors.size() == graph.vertices.size()) return report;

  const std::vector<Vertex> given = graph.vertices;
  report.start = initialize(graph, options);
  states = read_states(graph);
  solve(graph, residuals, losses, options, states, report);
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
  report.edges = evaluate_edges(graph, residuals, states, losses);
  report.final_cost = sum_cost(report.edges, losses);
  return report;
}

std::vector<EdgeResult> evaluate_edges(const PoseGraph& graph, const OptimizeOptions& options) {
  check(graph, options);
  std::vector<State> states = read_states(graph);
  return evaluate_edges(graph, make_residuals(graph, options.objective), states, edge_losses(graph, options));
}

double evaluate_cost(const PoseGraph& graph, const OptimizeOptions& options) {
  return sum_cost(evaluate_edges(graph, options), edge_losses(graph, options));
}

}  // namespace fabloop
