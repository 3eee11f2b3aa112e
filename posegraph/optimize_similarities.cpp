// SPDX-License-Identifier: BSD-3-Clause
#include <ceres/manifold.h>
#include <ceres/problem.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "frontend/error.h"
#include "posegraph/connectivity.h"
#include "posegraph/information.h"
#include "posegraph/residuals/similarity_residual.h"
#include "posegraph/residuals/sparse_solver.h"
#include "posegraph/residuals/yaw_manifold.h"
#include "posegraph/rigid_part.h"
#include "posegraph/similarity_graph.h"
#include "verification/chi_square.h"

namespace fabloop {
namespace {

constexpr int kDegreesOfFreedom = 7;

/// A vertex: quaternion (x y z w), translation and logarithm of the scale.
using SimilarityState = std::array<double, 8>;

std::vector<SimilarityState> read_states(const SimilarityGraph& graph) {
  std::vector<SimilarityState> states;
  states.reserve(graph.vertices.size());
  for (const SimilarityVertex& vertex : graph.vertices) {
    const auto& [scale, q, t] = vertex.world_from_frame;
    states.push_back({q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z(), std::log(scale)});
  }
  return states;
}

Similarity similarity_from_state(const SimilarityState& s) {
  return {std::exp(s[7]), Eigen::Quaterniond(s[3], s[0], s[1], s[2]).normalized(), {s[4], s[5], s[6]}};
}

/// The residuals and losses of a graph under some options.
class Costs {
 public:
  Costs(const SimilarityGraph& graph, const OptimizeOptions& options)
      : graph_(graph), loss_(options.robust_loss), c2_(chi_square_quantile(options.robust_probability, kDegreesOfFreedom)) {
    const auto& kinds = options.robust_kinds;
    for (const SimilarityEdge& edge : graph.edges) {
      residuals_.push_back(std::make_unique<residuals::SimilarityResidual>(edge, options.objective));
      is_robust_.push_back(std::find(kinds.begin(), kinds.end(), edge.kind) != kinds.end());
    }
  }

  std::vector<EdgeResult> evaluate(std::vector<SimilarityState> states) const {
    std::vector<EdgeResult> results;
    results.reserve(residuals_.size());
    for (std::size_t e = 0; e < residuals_.size(); ++e) {
      const std::vector<double*> blocks = blocks_of(e, states);
      Vector7d error;
      residuals_[e]->Evaluate(blocks.data(), error.data(), nullptr);
      results.push_back({error.squaredNorm(), robust_weight(loss_of(e), error.squaredNorm(), c2_)});
    }
    return results;
  }

  double sum(const std::vector<EdgeResult>& edges) const {
    double cost = 0.0;
    for (std::size_t e = 0; e < edges.size(); ++e) cost += robust_cost(loss_of(e), edges[e].chi2, c2_);
    return cost;
  }

  void add_to(ceres::Problem& problem, std::vector<SimilarityState>& states, residuals::Loss& loss) const {
    for (std::size_t e = 0; e < residuals_.size(); ++e) {
      problem.AddResidualBlock(residuals_[e].get(), loss_of(e) == RobustLoss::None ? nullptr : &loss, blocks_of(e, states));
    }
  }

  double c2() const { return c2_; }

 private:
  RobustLoss loss_of(std::size_t e) const { return is_robust_[e] ? loss_ : RobustLoss::None; }

  std::vector<double*> blocks_of(std::size_t e, std::vector<SimilarityState>& states) const {
    double* const i = states[graph_.edges[e].from].data();
    double* const j = states[graph_.edges[e].to].data();
    return {i, i + 4, j, j + 4};
  }

  const SimilarityGraph& graph_;
  RobustLoss loss_;
  double c2_;
  std::vector<std::unique_ptr<residuals::SimilarityResidual>> residuals_;
  std::vector<bool> is_robust_;
};

void check(const SimilarityGraph& graph, const OptimizeOptions& options) {
  check(graph);
  if (!(options.robust_probability > 0.0 && options.robust_probability < 1.0)) {
    throw InputError("robust probability must be between 0 and 1, both excluded");
  }
  if (options.initialization == Initialization::Sessions) {
    throw InputError("similarities have no start by sessions; take the chordal relaxation or the spanning tree");
  }
  if (options.freedom == Freedom::YawAndPosition && options.initialization != Initialization::AsGiven) {
    throw InputError("yaw and position only: roll and pitch are those of the poses given, so start from them");
  }
}

OptimizeReport describe(const SimilarityGraph& graph, Objective objective) {
  const PoseGraph rigid = rigid_part(graph);
  const Components components = connected_components(rigid);
  OptimizeReport report;
  report.anchors = find_anchors(rigid, components);
  report.num_components = components.count;
  for (const SimilarityEdge& edge : graph.edges) {
    // The chordal objective reads traces only, which need no mending.
    if (objective != Objective::Chordal && !is_positive_semidefinite(edge.information)) ++report.num_mended_information;
  }
  return report;
}

void initialize(SimilarityGraph& graph, Initialization initialization) {
  if (initialization == Initialization::SpanningTree) chain_along_edges(graph);
  if (initialization == Initialization::Chordal) initialize_chordal(graph);
}

/// Puts the graph at its start and says which one that is; `given_cost` is that of the poses given.
Initialization choose_start(SimilarityGraph& graph, const Costs& costs, double given_cost, const OptimizeOptions& options) {
  if (options.initialization != Initialization::LowestCost) {
    initialize(graph, options.initialization);
    return options.initialization;
  }
  Initialization best = Initialization::AsGiven;
  double lowest_cost = given_cost;
  const SimilarityGraph given = graph;
  for (const Initialization candidate : {Initialization::SpanningTree, Initialization::Chordal}) {
    SimilarityGraph start = given;
    initialize(start, candidate);
    const double cost = costs.sum(costs.evaluate(read_states(start)));
    if (cost >= lowest_cost) continue;
    best = candidate;
    lowest_cost = cost;
    graph.vertices = std::move(start.vertices);
  }
  return best;
}

/// Lets Ceres move the states.
residuals::SolverRun solve(const Costs& costs, const OptimizeReport& report, const OptimizeOptions& options,
                           std::vector<SimilarityState>& states) {
  ceres::EigenQuaternionManifold quaternion;
  residuals::YawManifold yaw;
  residuals::Loss loss(options.robust_loss, costs.c2());
  ceres::Problem problem(residuals::unowned());
  for (SimilarityState& state : states) {
    ceres::Manifold* const rotations =
        options.freedom == Freedom::YawAndPosition ? static_cast<ceres::Manifold*>(&yaw) : &quaternion;
    problem.AddParameterBlock(state.data(), 4, rotations);
    problem.AddParameterBlock(state.data() + 4, 4);
  }
  for (const std::size_t v : report.anchors) {
    problem.SetParameterBlockConstant(states[v].data());
    problem.SetParameterBlockConstant(states[v].data() + 4);
  }
  costs.add_to(problem, states, loss);
  return residuals::run(options, report.start, problem);
}

}  // namespace

OptimizeReport optimize(SimilarityGraph& graph, const OptimizeOptions& options) {
  check(graph, options);
  OptimizeReport report = describe(graph, options.objective);
  const Costs costs(graph, options);
  report.edges = costs.evaluate(read_states(graph));
  report.initial_cost = report.final_cost = costs.sum(report.edges);
  if (graph.edges.empty() || report.anchors.size() == graph.vertices.size()) return report;

  const std::vector<SimilarityVertex> given = graph.vertices;
  report.start = choose_start(graph, costs, report.initial_cost, options);
  std::vector<SimilarityState> states = read_states(graph);
  const residuals::SolverRun run = solve(costs, report, options, states);
  report.termination = run.termination;
  report.iterations = run.iterations;
  if (run.termination == Termination::Failed) {
    graph.vertices = given;
    return report;
  }
  for (std::size_t v = 0; v < states.size(); ++v) {
    if (!std::binary_search(report.anchors.begin(), report.anchors.end(), v)) {
      graph.vertices[v].world_from_frame = similarity_from_state(states[v]);
    }
  }
  report.edges = costs.evaluate(read_states(graph));
  report.final_cost = costs.sum(report.edges);
  return report;
}

double evaluate_cost(const SimilarityGraph& graph, const OptimizeOptions& options) {
  check(graph, options);
  const Costs costs(graph, options);
  return costs.sum(costs.evaluate(read_states(graph)));
}

}  // namespace fabloop
