// SPDX-License-Identifier: BSD-3-Clause
#include "verification/rig/camera_pair_groups.h"

#include <array>
#include <map>

namespace fabloop {

CameraPairGroups group_by_camera_pair(std::span<const RigRayPair> pairs) {
  using Origins = std::array<double, 6>;
  std::map<Origins, std::size_t> group_at;
  CameraPairGroups groups;
  groups.group_of.reserve(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d& c = pairs[i].query.origin_in_body;
    const Eigen::Vector3d& d = pairs[i].match.origin_in_body;
    const auto [at, is_new] = group_at.try_emplace(Origins{c.x(), c.y(), c.z(), d.x(), d.y(), d.z()}, groups.members.size());
    if (is_new) groups.members.emplace_back();
    groups.members[at->second].push_back(i);
    groups.group_of.push_back(at->second);
  }
  return groups;
}

}  // namespace fabloop
