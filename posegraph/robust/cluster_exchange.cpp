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

/// The truncated cost must fall by more than solves this rough may err, in parts of what they fit.
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
    best_ = settled({graph_.vertices, problem_.weights, {}, 0.0, 0.0, 0}, Initialization::AsGiven);
    if (options_.begins_anew) begin_anew();
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

  bool is_better(const TruncatedChoice& trial) const { return trial.cost < best_.cost - kLeastGain * best_.fitted_cost; }

  /// The best choice so far with some loops (positions in `loops_`) changed; taken over where the cost falls.
  /// What failed once is not tried again: other clusters that changed place since seldom make it better.
  bool try_with(const Cluster& members, double weight, Initialization initialization) {
    if (failed_.count({members, weight}) > 0) return false;
    TruncatedChoice trial = best_;
    for (const std::size_t k : members) trial.weights[loops_.edges()[k]] = weight;
    trial = settled(trial, initialization);
    if (!is_better(trial)) {
      failed_.emplace(members, weight);
      return false;
    }
    best_ = std::move(trial);
    return true;
  }

  /// With the loops that one would begin with under the noise as it is known by now.
  void begin_anew() {
    const LoopTrial begin = choose_trial(graph_, loops_, doubted_);
    TruncatedChoice trial = best_;
    for (std::size_t k = 0; k < loops_.size(); ++k) {
      const std::size_t e = loops_.edges()[k];
      if (problem_.is_doubted[e]) trial.weights[e] = begin.is_tried[k] ? 1.0 : 0.0;
    }
    trial = settled(trial, relaxation_of(optimize_));
    if (is_better(trial)) best_ = std::move(trial);
  }

  bool is_kept(std::size_t k) const { return best_.weights[loops_.edges()[k]] > 0.5; }

  /// Over what is trusted and the loops kept.
  SurePaths paths_kept() const {
    SurePaths paths(graph_, doubted_);
    for (std::size_t k = 0; k < loops_.size(); ++k) {
      if (is_kept(k)) paths.add(loops_.edges()[k]);
    }
    return paths;
  }

  std::vector<Cluster> candidates_to_let_in() const {
    const SurePaths paths = paths_kept();
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
      const bool is_lower = try_with(cluster, 1.0, relaxation_of(optimize_));
      num_failures = is_lower ? 0 : num_failures + 1;
      result_.num_let_in += is_lower;
      has_let_in = has_let_in || is_lower;
    }
    return has_let_in;
  }

  /// What the others contradict most comes first.
  std::vector<Cluster> candidates_to_leave_out() const {
    SurePaths paths = paths_kept();
    std::size_t num_kept = 0;
    for (std::size_t k = 0; k < loops_.size(); ++k) num_kept += is_kept(k);
    std::vector<std::pair<double, Cluster>> contradicted;
    for (const Cluster& cluster : clusters_) {
      Cluster kept;
      std::copy_if(cluster.begin(), cluster.end(), std::back_inserter(kept), [&](std::size_t k) { return is_kept(k); });
      // The thresholds judge a loop that has no neighbours, and what most loops say cannot be the odd one out.
      if (cluster.size() < 2 || kept.empty() || 2 * kept.size() > num_kept) continue;
      for (const std::size_t k : kept) paths.remove(loops_.edges()[k]);
      const double by_others = contradiction(graph_, loops_, paths, kept);
      for (const std::size_t k : kept) paths.add(loops_.edges()[k]);
      contradicted.emplace_back(by_others, std::move(kept));
    }
    std::stable_sort(contradicted.begin(), contradicted.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Cluster> result;
    for (auto& [by_others, cluster] : contradicted) result.push_back(std::move(cluster));
    return result;
  }

  bool leave_out() {
    bool has_left_out = false;
    std::size_t num_failures = 0;
    for (const Cluster& cluster : candidates_to_leave_out()) {
      if (num_failures == options_.max_failures) break;
      const bool is_lower = try_with(cluster, 0.0, Initialization::AsGiven);
      num_failures = is_lower ? 0 : num_failures + 1;
      result_.num_left_out += is_lower;
      has_left_out = has_left_out || is_lower;
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
