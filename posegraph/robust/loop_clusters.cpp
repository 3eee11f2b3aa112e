// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/loop_clusters.h"

#include <algorithm>

#include "posegraph/disjoint_sets.h"

namespace fabloop {
namespace {

/// At most three members, evenly spread.
std::vector<std::size_t> spokesmen(const std::vector<std::size_t>& cluster) {
  if (cluster.size() <= 3) return cluster;
  return {cluster.front(), cluster[cluster.size() / 2], cluster.back()};
}

}  // namespace

std::vector<std::vector<std::size_t>> cluster_loops(const LoopConsistency& loops, const LoopClusterOptions& options) {
  DisjointSets sets(loops.size());
  for (std::size_t a = 0; a < loops.size(); ++a) {
    for (const std::size_t b : loops.nearest(a, options.max_neighbours, options.max_steps)) {
      if (sets.root_of(a) != sets.root_of(b) && loops.are_consistent(a, b)) sets.join(a, b);
    }
  }
  std::vector<std::vector<std::size_t>> by_root(loops.size());
  for (std::size_t k = 0; k < loops.size(); ++k) by_root[sets.root_of(k)].push_back(k);
  std::erase_if(by_root, [](const auto& cluster) { return cluster.empty(); });
  std::stable_sort(by_root.begin(), by_root.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return by_root;
}

double contradiction(const PoseGraph& graph, const LoopConsistency& loops, const SurePaths& paths,
                     const std::vector<std::size_t>& cluster) {
  std::vector<double> of_members;
  for (const std::size_t k : spokesmen(cluster)) {
    const Edge& edge = graph.edges[loops.edges()[k]];
    const auto path = paths.find(edge.from, edge.to);
    of_members.push_back(path ? loops.contradiction(k, *path) : 0.0);
  }
  std::sort(of_members.begin(), of_members.end());
  return of_members[of_members.size() / 2];
}

bool is_agreed_by(const PoseGraph& graph, const LoopConsistency& loops, const SurePaths& paths,
                  const std::vector<std::size_t>& cluster) {
  return contradiction(graph, loops, paths, cluster) <= 1.0;
}

LoopTrial choose_trial(const PoseGraph& graph, const LoopConsistency& loops, const std::vector<EdgeKind>& doubted,
                       const LoopClusterOptions& options) {
  SurePaths paths(graph, doubted);
  LoopTrial trial{std::vector<bool>(loops.size(), false), std::vector<bool>(loops.size(), false)};
  std::vector<std::size_t> tried;
  std::vector<std::size_t> ends;
  for (const std::vector<std::size_t>& cluster : cluster_loops(loops, options)) {
    if (cluster.size() < 2) break;
    if (!is_agreed_by(graph, loops, paths, cluster)) continue;
    for (const std::size_t k : cluster) {
      trial.is_tried[k] = true;
      paths.add(loops.edges()[k]);
      tried.push_back(k);
    }
    ends.push_back(tried.size());
  }
  // Whole clusters, so that the half may be more.
  const auto end = std::find_if(ends.begin(), ends.end(), [&](std::size_t count) { return 2 * count >= tried.size(); });
  for (std::size_t k = 0; end != ends.end() && k < *end; ++k) trial.is_foremost[tried[k]] = true;
  return trial;
}

}  // namespace fabloop
