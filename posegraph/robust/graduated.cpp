// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/graduated.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "posegraph/robust/weighted_solve.h"

namespace fabloop {
namespace {

/// Poses follow the weights closely enough when each step lets the solver go this far.
constexpr int kIterationsInStep = 2;
constexpr int kIterationsOfAll = 20;
constexpr double kToleranceInStep = 1e-4;

/// Weights below this pull less than rounding; without them the solver's matrices stay sparse.
constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr double kLeastWeight = 1e-7;

/// Errors up to this many thresholds count as convex when the rest joins the candidates: edges up to twice as far off have a say.
constexpr double kLateRatio = 2.0;

/// mu at which the surrogate of truncated least squares passes into the cost itself: it differs within a tenth of the threshold.
constexpr double kFinalTruncatedMu = 10.0;

/// Alternations of choice and solve at the end, where a few edges may come and go.
constexpr int kMaxFinalSteps = 10;

class Graduation {
 public:
  Graduation(PoseGraph& graph, const GraduatedProblem& problem, const OptimizeOptions& options)
      : graph_(graph), problem_(problem), options_(options) {
    options_.robust_loss = RobustLoss::None;
    edges_.has_loss.assign(graph.edges.size(), false);
    edges_.weights = problem.weights;
  }

  GraduatedResult run() {
    if (std::find(problem_.is_candidate.begin(), problem_.is_candidate.end(), true) != problem_.is_candidate.end()) {
      solve(kIterationsOfAll, kToleranceInStep);
      pass(problem_.is_candidate, max_ratio(problem_.is_candidate));
    }
    pass(problem_.is_doubted, kLateRatio);
    OptimizeReport report = solve(options_.max_iterations, options_.cost_tolerance);
    return {edges_.weights, num_solves_, std::move(report)};
  }

 private:
  bool is_truncated() const { return problem_.surrogate == Surrogate::TruncatedLeastSquares; }

  /// Largest error of the members, in thresholds.
  double max_ratio(const std::vector<bool>& members) const {
    const std::vector<double> chi2 = evaluate_chi2(graph_, options_.objective);
    double largest = 0.0;
    for (std::size_t e = 0; e < chi2.size(); ++e) {
      if (members[e]) largest = std::max(largest, chi2[e] / problem_.c2[e]);
    }
    return largest;
  }

  /// From the surrogate that is convex up to `ratio` thresholds to the robust cost.
  void pass(const std::vector<bool>& members, double ratio) {
    if (is_truncated()) {
      for (double mu = convex_mu(problem_.surrogate, ratio, 1.0); mu < kFinalTruncatedMu && ratio > 1.0; mu *= problem_.factor) {
        update_weights(members, mu);
        solve(kIterationsInStep, kToleranceInStep);
      }
      for (int k = 0; k < kMaxFinalSteps && update_weights(members, kInfinity); ++k) solve(kIterationsInStep, kToleranceInStep);
      return;
    }
    for (double mu = convex_mu(problem_.surrogate, ratio, 1.0); mu > 1.0; mu = std::max(1.0, mu / problem_.factor)) {
      update_weights(members, mu);
      solve(kIterationsInStep, kToleranceInStep);
    }
    for (int k = 0; k < kMaxFinalSteps; ++k) {
      update_weights(members, 1.0);
      solve(kIterationsInStep, kToleranceInStep);
    }
  }

  /// Returns whether a weight changed.
  bool update_weights(const std::vector<bool>& members, double mu) {
    const std::vector<double> chi2 = evaluate_chi2(graph_, options_.objective);
    bool changed = false;
    for (std::size_t e = 0; e < chi2.size(); ++e) {
      if (!problem_.is_doubted[e]) continue;
      double weight = members[e] ? graduated_weight(problem_.surrogate, chi2[e], problem_.c2[e], mu) : 0.0;
      if (weight < kLeastWeight) weight = 0.0;
      changed = changed || weight != edges_.weights[e];
      edges_.weights[e] = weight;
    }
    return changed;
  }

  OptimizeReport solve(int max_iterations, double cost_tolerance) {
    ++num_solves_;
    OptimizeOptions options = options_;
    options.max_iterations = std::min(max_iterations, options_.max_iterations);
    options.cost_tolerance = cost_tolerance;
    return solve_weighted(graph_, edges_, options);
  }

  PoseGraph& graph_;
  const GraduatedProblem& problem_;
  OptimizeOptions options_;
  EdgeWeights edges_;
  std::size_t num_solves_ = 0;
};

}  // namespace

double graduated_weight(Surrogate surrogate, double chi2, double c2, double mu) {
  if (surrogate == Surrogate::GemanMcClure) {
    const double root = mu * c2 / (chi2 + mu * c2);
    return root * root;
  }
  if (mu == kInfinity) return chi2 <= c2 ? 1.0 : 0.0;
  if (chi2 >= (mu + 1.0) / mu * c2) return 0.0;
  if (chi2 <= mu / (mu + 1.0) * c2) return 1.0;
  return std::sqrt(c2 / chi2 * mu * (mu + 1.0)) - mu;
}

double convex_mu(Surrogate surrogate, double max_chi2, double c2) {
  if (surrogate == Surrogate::GemanMcClure) return std::max(1.0, 2.0 * max_chi2 / c2);
  return c2 / std::max(2.0 * max_chi2 - c2, c2);
}

GraduatedResult graduate(PoseGraph& graph, const GraduatedProblem& problem, const OptimizeOptions& options) {
  return Graduation(graph, problem, options).run();
}

}  // namespace fabloop
