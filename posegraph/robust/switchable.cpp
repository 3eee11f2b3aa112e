// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/switchable.h"

#include <ceres/cost_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "posegraph/connectivity.h"
#include "posegraph/residuals/residuals.h"
#include "posegraph/residuals/sparse_solver.h"
#include "posegraph/residuals/yaw_manifold.h"
#include "posegraph/robust/weighted_solve.h"
#include "posegraph/solver_state.h"

namespace fabloop {
namespace {

/// The residual of an edge times its switch, and one more for the switch: blocks as the edge's, then the switch.
class SwitchedResidual final : public ceres::CostFunction {
 public:
  SwitchedResidual(std::unique_ptr<ceres::CostFunction> edge, double c2) : edge_(std::move(edge)), c_(std::sqrt(c2)) {
    *mutable_parameter_block_sizes() = edge_->parameter_block_sizes();
    mutable_parameter_block_sizes()->push_back(1);
    set_num_residuals(edge_->num_residuals() + 1);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const std::size_t num_blocks = edge_->parameter_block_sizes().size();
    const double value = parameters[num_blocks][0];
    if (!edge_->Evaluate(parameters, residuals, jacobians)) return false;
    const int size = edge_->num_residuals();
    Eigen::Map<Eigen::VectorXd> error(residuals, size);
    if (jacobians != nullptr) {
      for (std::size_t block = 0; block < num_blocks; ++block) {
        if (jacobians[block] == nullptr) continue;
        const int width = edge_->parameter_block_sizes()[block];
        Eigen::Map<Eigen::VectorXd>(jacobians[block], size * width) *= value;
        Eigen::Map<Eigen::VectorXd>(jacobians[block] + size * width, width).setZero();
      }
      if (jacobians[num_blocks] != nullptr) {
        Eigen::Map<Eigen::VectorXd>(jacobians[num_blocks], size) = error;
        jacobians[num_blocks][size] = -c_;
      }
    }
    error *= value;
    residuals[size] = c_ * (1.0 - value);
    return true;
  }

 private:
  std::unique_ptr<ceres::CostFunction> edge_;
  double c_;
};

/// Poses as Ceres moves them, and a switch an edge.
class SwitchedSolve {
 public:
  SwitchedSolve(PoseGraph& graph, const SwitchableProblem& problem)
      : graph_(graph), problem_(problem), switches_(graph.edges.size(), 1.0) {}

  OptimizeReport run(const OptimizeOptions& options) {
    states_ = read_states(graph_);
    ceres::Problem ceres_problem(problem_options());
    build(ceres_problem, options);
    const residuals::SolverRun run = residuals::run(options, Initialization::AsGiven, ceres_problem);
    OptimizeReport report;
    report.initial_cost = run.initial_cost;
    report.final_cost = run.final_cost;
    report.iterations = run.iterations;
    report.termination = run.termination;
    report.anchors = anchors_;
    report.num_components = num_components_;
    if (report.termination == Termination::Failed) return report;
    for (std::size_t v = 0; v < states_.size(); ++v) {
      if (!std::binary_search(anchors_.begin(), anchors_.end(), v)) {
        graph_.vertices[v].world_from_frame = pose_from_state(states_[v], graph_.dimension);
      }
    }
    return report;
  }

  /// s^2 of the edges with a switch, 0 of those left out, 1 of the others.
  std::vector<double> weights() const {
    std::vector<double> result = problem_.weights;
    for (std::size_t e = 0; e < result.size(); ++e) {
      if (problem_.has_switch[e]) result[e] = std::min(1.0, switches_[e] * switches_[e]);
    }
    return result;
  }

 private:
  static ceres::Problem::Options problem_options() {
    ceres::Problem::Options options;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  void build(ceres::Problem& ceres_problem, const OptimizeOptions& options) {
    ceres::Manifold* const rotations =
        options.freedom == Freedom::YawAndPosition ? static_cast<ceres::Manifold*>(&yaw_) : &quaternion_;
    for (State& state : states_) {
      if (graph_.dimension == 2) {
        ceres_problem.AddParameterBlock(state.data(), 3);
      } else {
        ceres_problem.AddParameterBlock(state.data(), 4, rotations);
        ceres_problem.AddParameterBlock(state.data() + 4, 3);
      }
    }
    PoseGraph used = graph_;
    used.edges.clear();
    for (std::size_t e = 0; e < graph_.edges.size(); ++e) {
      if (problem_.weights[e] == 0.0) continue;
      const Edge& edge = graph_.edges[e];
      used.edges.push_back(edge);
      std::vector<double*> blocks = blocks_of(edge, graph_.dimension, states_);
      std::unique_ptr<ceres::CostFunction> residual = residuals::make_residual(edge, graph_.dimension, options.objective);
      if (problem_.has_switch[e]) {
        blocks.push_back(&switches_[e]);
        residual = std::make_unique<SwitchedResidual>(std::move(residual), problem_.c2[e]);
      }
      ceres_problem.AddResidualBlock(residual.release(), nullptr, blocks);
    }
    const Components components = connected_components(used);
    num_components_ = components.count;
    anchors_ = find_anchors(used, components);
    for (const std::size_t v : anchors_) {
      ceres_problem.SetParameterBlockConstant(states_[v].data());
      if (graph_.dimension == 3) ceres_problem.SetParameterBlockConstant(states_[v].data() + 4);
    }
  }

  PoseGraph& graph_;
  const SwitchableProblem& problem_;
  ceres::EigenQuaternionManifold quaternion_;
  residuals::YawManifold yaw_;
  std::vector<State> states_;
  std::vector<double> switches_;
  std::vector<std::size_t> anchors_;
  std::size_t num_components_ = 0;
};

}  // namespace

SwitchableResult solve_with_switches(PoseGraph& graph, const SwitchableProblem& problem, const OptimizeOptions& options) {
  SwitchedSolve solve(graph, problem);
  SwitchableResult result;
  result.solve = solve.run(options);
  result.weights = solve.weights();
  const std::vector<double> chi2 = evaluate_chi2(graph, options.objective);
  for (std::size_t e = 0; e < chi2.size(); ++e) {
    if (problem.weights[e] != 0.0) result.solve.edges.push_back({chi2[e], result.weights[e]});
  }
  return result;
}

}  // namespace fabloop
