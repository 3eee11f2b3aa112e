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

#include "frontend/error.h"
#include "posegraph/connectivity.h"
#include "posegraph/information.h"
#include "posegraph/residuals.h"
#include "verification/chi_square.h"

namespace fabloop {
namespace {

/// A vertex as Ceres moves it: quaternion (x y z w) and translation, or (x, y, yaw) in the first three.
using State = std::array<double, 7>;

std::vector<State> read_states(const PoseGraph& graph) {
  std::vector<State> states;
  states.reserve(graph.vertices.size());
  for (const Vertex& vertex : graph.vertices) {
    const auto& [q, t] = vertex.world_from_frame;
    if (graph.dimension == 2) {
      states.push_back({t.x(), t.y(), 2.0 * std::atan2(q.z(), q.w())});
    } else {
      states.push_back({q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()});
    }
  }
  return states;
}

Pose pose_from_state(const State& s, int dimension) {
  if (dimension == 2) return {Eigen::Quaterniond(std::cos(0.5 * s[2]), 0.0, 0.0, std::sin(0.5 * s[2])), {s[0], s[1], 0.0}};
  return {Eigen::Quaterniond(s[3], s[0], s[1], s[2]).normalized(), {s[4], s[5], s[6]}};
}

/// The parameter blocks of an edge's residual.
std::vector<double*> blocks_of(const Edge& edge, int dimension, std::vector<State>& states) {
  double* const i = states[edge.from].data();
  double* const j = states[edge.to].data();
  if (dimension == 2) return {i, j};
  return {i, i + 4, j, j + 4};
}

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

EdgeLoss loss_of(const Edge& edge, int dimension, const OptimizeOptions& options) {
  const auto& kinds = options.robust_kinds;
  if (std::find(kinds.begin(), kinds.end(), edge.kind) == kinds.end()) return {};
  const int degrees_of_freedom = dimension == 2 ? 3 : edge.has_scale ? 6 : 5;
  return {options.robust_loss, chi_square_quantile(options.robust_probability, degrees_of_freedom)};
}

class ReportProgress final : public ceres::IterationCallback {
 public:
  explicit ReportProgress(const OptimizeOptions& options) : options_(options) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (options_.progress) {
      options_.progress("optimize", static_cast<std::size_t>(summary.iteration),
                        static_cast<std::size_t>(options_.max_iterations));
    }
    if (!options_.cancelled || !options_.cancelled()) return ceres::SOLVER_CONTINUE;
    cancelled = true;
    // "Successfully" makes Ceres hand back the best poses so far.
    return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

  bool cancelled = false;

 private:
  const OptimizeOptions& options_;
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
                                       const OptimizeOptions& options) {
  std::vector<EdgeResult> results;
  results.reserve(graph.edges.size());
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const Edge& edge = graph.edges[e];
    std::array<double, residuals::ChordalResidual::kSize> residual{};
    residuals[e]->Evaluate(blocks_of(edge, graph.dimension, states).data(), residual.data(), nullptr);
    double chi2 = 0.0;
    for (const double r : residual) chi2 += r * r;
    const EdgeLoss loss = loss_of(edge, graph.dimension, options);
    results.push_back({chi2, robust_weight(loss.loss, chi2, loss.c2)});
  }
  return results;
}

double sum_cost(const PoseGraph& graph, const std::vector<EdgeResult>& results, const OptimizeOptions& options) {
  double cost = 0.0;
  for (std::size_t e = 0; e < results.size(); ++e) {
    const EdgeLoss loss = loss_of(graph.edges[e], graph.dimension, options);
    cost += robust_cost(loss.loss, results[e].chi2, loss.c2);
  }
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
           const OptimizeOptions& options, std::vector<State>& states, Solver& solver, ceres::Problem& problem) {
  for (State& state : states) {
    if (graph.dimension == 2) {
      problem.AddParameterBlock(state.data(), 3);
    } else {
      problem.AddParameterBlock(state.data(), 4, &solver.quaternion);
      problem.AddParameterBlock(state.data() + 4, 3);
    }
  }
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const EdgeLoss loss = loss_of(graph.edges[e], graph.dimension, options);
    if (loss.loss != RobustLoss::None) solver.losses.push_back(std::make_unique<Loss>(loss.loss, loss.c2));
    problem.AddResidualBlock(residuals[e].get(), loss.loss == RobustLoss::None ? nullptr : solver.losses.back().get(),
                             blocks_of(graph.edges[e], graph.dimension, states));
  }
  for (const std::size_t v : anchors) {
    problem.SetParameterBlockConstant(states[v].data());
    if (graph.dimension == 3) problem.SetParameterBlockConstant(states[v].data() + 4);
  }
}

ceres::Solver::Options solver_options(const OptimizeOptions& options) {
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
  return result;
}

Termination termination_of(const ceres::Solver::Summary& summary, bool cancelled) {
  if (cancelled) return Termination::Cancelled;
  if (summary.termination_type == ceres::CONVERGENCE) return Termination::Converged;
  if (summary.termination_type == ceres::NO_CONVERGENCE) return Termination::MaxIterations;
  return Termination::Failed;
}

}  // namespace

OptimizeReport optimize(PoseGraph& graph, const OptimizeOptions& options) {
  check(graph, options);
  OptimizeReport report = describe(graph, options.objective);
  std::vector<State> states = read_states(graph);
  const Residuals residuals = make_residuals(graph, options.objective);
  report.edges = evaluate_edges(graph, residuals, states, options);
  report.initial_cost = report.final_cost = sum_cost(graph, report.edges, options);
  if (graph.edges.empty() || report.anchors.size() == graph.vertices.size()) return report;

  Solver solver;
  ceres::Problem problem(unowned());
  build(graph, residuals, report.anchors, options, states, solver, problem);
  ceres::Solver::Options ceres_options = solver_options(options);
  ReportProgress callback(options);
  ceres_options.callbacks.push_back(&callback);
  ceres::Solver::Summary summary;
  ceres::Solve(ceres_options, &problem, &summary);

  report.termination = termination_of(summary, callback.cancelled);
  report.iterations = std::max(0, static_cast<int>(summary.iterations.size()) - 1);
  if (report.termination == Termination::Failed) return report;
  for (std::size_t v = 0, next_anchor = 0; v < states.size(); ++v) {
    if (next_anchor < report.anchors.size() && report.anchors[next_anchor] == v) {
      ++next_anchor;
    } else {
      graph.vertices[v].world_from_frame = pose_from_state(states[v], graph.dimension);
    }
  }
  states = read_states(graph);
  report.edges = evaluate_edges(graph, residuals, states, options);
  report.final_cost = sum_cost(graph, report.edges, options);
  return report;
}

double evaluate_cost(const PoseGraph& graph, const OptimizeOptions& options) {
  return sum_cost(graph, evaluate_edges(graph, options), options);
}

std::vector<EdgeResult> evaluate_edges(const PoseGraph& graph, const OptimizeOptions& options) {
  check(graph, options);
  std::vector<State> states = read_states(graph);
  return evaluate_edges(graph, make_residuals(graph, options.objective), states, options);
}

}  // namespace fabloop
