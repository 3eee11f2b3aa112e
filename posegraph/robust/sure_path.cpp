// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/sure_path.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "posegraph/robust/odometry_tree.h"

namespace fabloop {

SurePaths::SurePaths(const PoseGraph& graph, const std::vector<EdgeKind>& doubted) : graph_(graph), hops_(graph.vertices.size()) {
  std::vector<std::size_t> trusted;
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const Edge& edge = graph.edges[e];
    if (!edge.has_scale || std::find(doubted.begin(), doubted.end(), edge.kind) != doubted.end()) continue;
    trusted.push_back(e);
    const Matrix6d covariance = edge_covariance(edge, graph.dimension);
    step_translation_ += covariance.topLeftCorner<3, 3>().trace();
    step_rotation_ += covariance.bottomRightCorner<3, 3>().trace();
  }
  const auto count = static_cast<double>(std::max<std::size_t>(1, trusted.size()));
  step_translation_ /= count;
  step_rotation_ /= count;
  for (const std::size_t e : trusted) add(e);
}

double SurePaths::length_of(const Matrix6d& covariance) const {
  const double translation = covariance.topLeftCorner<3, 3>().trace();
  const double rotation = covariance.bottomRightCorner<3, 3>().trace();
  return (step_translation_ > 0.0 ? translation / step_translation_ : translation) +
         (step_rotation_ > 0.0 ? rotation / step_rotation_ : rotation);
}

void SurePaths::add(std::size_t edge) {
  const Edge& added = graph_.edges[edge];
  if (!added.has_scale) return;
  const double length = length_of(edge_covariance(added, graph_.dimension));
  hops_[added.from].push_back({added.to, edge, length});
  hops_[added.to].push_back({added.from, edge, length});
}

void SurePaths::remove(std::size_t edge) {
  for (const std::size_t v : {graph_.edges[edge].from, graph_.edges[edge].to}) {
    std::erase_if(hops_[v], [&](const Hop& hop) { return hop.edge == edge; });
  }
}

std::optional<UncertainPose> SurePaths::find(std::size_t from, std::size_t to) const {
  std::vector<double> best(hops_.size(), std::numeric_limits<double>::infinity());
  std::vector<Hop> arrived_by(hops_.size());
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  best[from] = 0.0;
  queue.emplace(0.0, from);
  while (!queue.empty() && queue.top().second != to) {
    const auto [length, v] = queue.top();
    queue.pop();
    if (length > best[v]) continue;
    for (const Hop& hop : hops_[v]) {
      const double longer = length + hop.length;
      if (longer >= best[hop.vertex]) continue;
      best[hop.vertex] = longer;
      arrived_by[hop.vertex] = {v, hop.edge, hop.length};
      queue.emplace(longer, hop.vertex);
    }
  }
  if (queue.empty()) return std::nullopt;
  std::vector<std::size_t> edges;
  for (std::size_t v = to; v != from; v = arrived_by[v].vertex) edges.push_back(arrived_by[v].edge);
  std::reverse(edges.begin(), edges.end());
  return follow(from, edges);
}

UncertainPose SurePaths::follow(std::size_t from, const std::vector<std::size_t>& edges) const {
  UncertainPose result;
  std::size_t at = from;
  for (const std::size_t e : edges) {
    const Edge& edge = graph_.edges[e];
    const UncertainPose step{edge.from_from_to, edge_covariance(edge, graph_.dimension)};
    result = result * (edge.to == at ? inverse(step) : step);
    at = edge.to == at ? edge.from : edge.to;
  }
  return result;
}

}  // namespace fabloop
