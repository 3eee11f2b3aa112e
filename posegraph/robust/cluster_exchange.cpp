// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/cluster_exchange.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "posegraph/robust/loop_clusters.h"
#include "posegraph/robust/sure_path.h"
#include "posegraph/robust/weighted_solve.h"

namespace fabloop {
namespace {

/// The truncated cost must fall by more than solves this rough may err, in parts of it.
constexpr double kLeastGain = 1e-3;

using Cluster = std::vector<std::size_t>;  ///< Positions of edges in the graph.

class Exchange {
 public:
  Exchange(PoseGraph& graph, const TruncatedProblem& problem, const LoopConsistency& loops, const std::vector<EdgeKind>& doubted,
           const OptimizeOptions& optimize, const ClusterExchangeOptions& options)
      : graph_(graph), problem_(problem), loops_(loops), doubted_(doubted), optimize_(optimize), options_(options) {
    for (const Cluster& members : cluster_loops(loops)) {
      clusters_.emplace_back();
      for (const std::size_t k : members) {
        if (problem.is_doubted[loops.edges()[k]]) clusters_.back().push_back(k);
      }
    }
  }

  ClusterExchange run() {
    best_ = settled({graph_.vertices, problem_.weights, {}, 0.0, 0}, Initialization::AsGiven);
    for (std::size_t round = 0; round < options_.max_rounds; ++round) {
      const bool has_let_in = let_in();
      const bool has_left_out = leave_out();
      if (!has_let_in && !has_left_out) break;
    }
    graph_.vertices = std::move(best_.vertices);
    result_.weights = std::move(best_.weights);
    result_.cost = best_.cost;
    return result_;
  }

 private:
  TruncatedChoice settled(const TruncatedChoice& start, Initialization initialization) {
    graph_.vertices = start.vertices;
    TruncatedProblem problem = problem_;
    problem.weights = start.weights;
    OptimizeOptions options = optimize_;
    options.initialization = initialization;
    TruncatedChoice result = settle(graph_, problem, options, best_.weights);
    result_.num_solves += result.num_solves;
    return result;
  }

  /// The best choice so far with some loops (positions in `loops_`) changed; taken over where the cost falls.
  /// What failed once is not tried again: other clusters that changed place since seldom make it better.
  bool try_with(const Cluster& members, double weight, Initialization initialization) {
    if (failed_.count({members, weight}) > 0) return false;
    TruncatedChoice trial = best_;
    for (const std::size_t k : members) trial.weights[loops_.edges()[k]] = weight;
    trial = settled(trial, initialization);
    if (trial.weights == best_.weights || trial.cost >= (1.0 - kLeastGain) * best_.cost) {
      failed_.emplace(members, weight);
      return false;
    }
    best_ = std::move(trial);
    return true;
  }

  bool is_kept(std::size_t k) const { return best_.weights[loops_.edges()[k]] > 0.5; }

  std::vector<Cluster> candidates_to_let_in() const {
    SurePaths paths(graph_, doubted_);
    for (std::size_t k = 0; k < loops_.size(); ++k) {
      if (is_kept(k)) paths.add(loops_.edges()[k]);
    }
    std::vector<Cluster> result;
    for (const Cluster& cluster : clusters_) {
      Cluster left_out;
      std::copy_if(cluster.begin(), cluster.end(), std::back_inserter(left_out), [&](std::size_t k) { return !is_kept(k); });
      if (left_out.size() < 2) continue;
      if (is_agreed_by(graph_, loops_, paths, left_out)) result.push_back(std::move(left_out));
    }
    std::stable_sort(result.begin(), result.end(), [](const Cluster& a, const Cluster& b) { return a.size() > b.size(); });
    return result;
  }

  bool let_in() {
    const std::vector<Cluster> candidates = candidates_to_let_in();
    Cluster all;
    for (const Cluster& cluster : candidates) all.insert(all.end(), cluster.begin(), cluster.end());
    if (all.empty()) return false;
    if (try_with(all, 1.0, relaxation_of(optimize_))) {
      ++result_.num_let_in;
      return true;
    }
    bool has_let_in = false;
    std::size_t num_failures = 0;
    for (const Cluster& cluster : candidates) {
      if (num_failures == options_.max_failures) break;
      if (candidates.size() == 1) break;
      const bool is_better = try_with(cluster, 1.0, relaxation_of(optimize_));
      num_failures = is_better ? 0 : num_failures + 1;
      result_.num_let_in += is_better;
      has_let_in = has_let_in || is_better;
    }
    return has_let_in;
  }

  bool leave_out() {
    std::vector<std::pair<double, Cluster>> by_strain;
    std::size_t num_kept = 0;
    for (const Cluster& cluster : clusters_) {
      Cluster kept;
      double strain = 0.0;
      for (const std::size_t k : cluster) {
        const std::size_t e = loops_.edges()[k];
        strain += std::min(1.0, best_.chi2[e] / problem_.c2[e]);
        if (is_kept(k)) kept.push_back(k);
      }
      num_kept += kept.size();
      if (kept.empty()) continue;
      by_strain.emplace_back(strain / static_cast<double>(cluster.size()), std::move(kept));
    }
    std::stable_sort(by_strain.begin(), by_strain.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    bool has_left_out = false;
    std::size_t num_failures = 0;
    for (const auto& [strain, cluster] : by_strain) {
      if (num_failures == options_.max_failures) break;
      // What most loops say cannot be the odd one out.
      if (2 * cluster.size() > num_kept) continue;
      const bool is_better = try_with(cluster, 0.0, Initialization::AsGiven);
      num_failures = is_better ? 0 : num_failures + 1;
      result_.num_left_out += is_better;
      has_left_out = has_left_out || is_better;
    }
    return has_left_out;
  }

  PoseGraph& graph_;
  const TruncatedProblem& problem_;
  const LoopConsistency& loops_;
  const std::vector<EdgeKind>& doubted_;
  OptimizeOptions optimize_;
  ClusterExchangeOptions options_;
  std::vector<Cluster> clusters_;
  TruncatedChoice best_;
  std::set<std::pair<Cluster, double>> failed_;  ///< Members and their weight on trial.
  ClusterExchange result_;
};

}  // namespace

ClusterExchange exchange_clusters(PoseGraph& graph, const TruncatedProblem& problem, const LoopConsistency& loops,
                                  const std::vector<EdgeKind>& doubted, const OptimizeOptions& optimize,
                                  const ClusterExchangeOptions& options) {
  return Exchange(graph, problem, loops, doubted, optimize, options).run();
}

}  // namespace fabloop
