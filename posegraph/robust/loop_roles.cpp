// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/loop_roles.h"

#include <algorithm>
#include <string>

#include "frontend/error.h"
#include "posegraph/robust/loop_consistency.h"

namespace fabloop {

LoopRoles roles_of(const PoseGraph& graph, const RobustOptions& options) {
  LoopRoles roles;
  if (options.noise == NoiseScale::Observed) {
    roles.noise_scale = observed_noise_scale(LoopConsistency(graph, options.doubted, options.inlier_probability));
  }
  roles.c2 = thresholds(graph, options.inlier_probability);
  for (double& c2 : roles.c2) c2 *= roles.noise_scale;
  for (const Edge& edge : graph.edges) {
    const bool is_doubted = std::find(options.doubted.begin(), options.doubted.end(), edge.kind) != options.doubted.end();
    roles.forced.push_back(is_doubted ? EdgeVerdict::Kept : EdgeVerdict::Trusted);
  }
  const auto force = [&](const std::vector<std::size_t>& edges, EdgeVerdict verdict) {
    for (const std::size_t e : edges) {
      const std::string name = "robust back end: edge " + std::to_string(e) + " (counted from 0) ";
      if (e >= graph.edges.size()) throw InputError(name + "is forced, but is not there");
      if (roles.forced[e] == EdgeVerdict::Trusted) throw InputError(name + "is forced, but is trusted anyway: it is no loop");
      if (roles.forced[e] != EdgeVerdict::Kept && roles.forced[e] != verdict) {
        throw InputError(name + "is both accepted and rejected by force; choose one");
      }
      roles.forced[e] = verdict;
    }
  };
  force(options.accept, EdgeVerdict::ForcedAccept);
  force(options.reject, EdgeVerdict::ForcedReject);
  for (const EdgeVerdict verdict : roles.forced) roles.is_doubted.push_back(verdict == EdgeVerdict::Kept);
  return roles;
}

EdgeWeights weights_of(const LoopRoles& roles, double weight) {
  EdgeWeights edges;
  edges.has_loss.assign(roles.forced.size(), false);
  for (std::size_t e = 0; e < roles.forced.size(); ++e) {
    edges.weights.push_back(roles.is_doubted[e] ? weight : roles.forced[e] == EdgeVerdict::ForcedReject ? 0.0 : 1.0);
  }
  return edges;
}

}  // namespace fabloop
