// SPDX-License-Identifier: BSD-3-Clause
#include "apps/live/live_map.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace fabloop::apps {
namespace {

/// A fraction of a pixel of a map that fills a screen.
constexpr double kVisibleShare = 2e-4;

/// Both ascending: whether every frame before is there now.
bool holds_all(const std::vector<LivePosition>& now, const std::vector<LivePosition>& before) {
  return std::includes(now.begin(), now.end(), before.begin(), before.end(),
                       [](const LivePosition& a, const LivePosition& b) { return a.frame < b.frame; });
}

void number_track(const std::vector<LivePosition>& before, std::vector<LivePosition>& now, double tolerance,
                  std::uint64_t& last_change) {
  auto known = before.begin();
  for (LivePosition& position : now) {
    while (known != before.end() && known->frame < position.frame) ++known;
    const bool is_known = known != before.end() && known->frame == position.frame;
    if (is_known && (known->x_in_world - position.x_in_world).norm() <= tolerance) {
      position = *known;
    } else {
      position.changed = ++last_change;
    }
  }
}

void number_loops(const std::vector<LiveLoop>& before, std::vector<LiveLoop>& now, std::uint64_t& last_change) {
  for (std::size_t i = 0; i < now.size(); ++i) {
    const bool is_same = i < before.size() && before[i].query == now[i].query && before[i].match == now[i].match &&
                         before[i].verdict == now[i].verdict && before[i].num_inliers == now[i].num_inliers;
    now[i].changed = is_same ? before[i].changed : ++last_change;
  }
}

/// The present vertical, or the one before while they differ too little for the map to be turned.
Eigen::Vector3d steady_vertical(const LiveMap& before, const std::vector<LivePosition>& placed) {
  constexpr double kSteadyCosine = 0.97;  // 14 degrees
  constexpr std::size_t kFewest = 3;      // of a plane
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(placed.size()));
  for (std::size_t i = 0; i < placed.size(); ++i) positions.col(static_cast<Eigen::Index>(i)) = placed[i].x_in_world;
  const Eigen::Vector3d now = vertical_of(positions);
  return before.placed.size() >= kFewest && now.dot(before.up) > kSteadyCosine ? before.up : now;
}

}  // namespace

double LiveMap::extent() const {
  if (placed.empty()) return 0.0;
  Eigen::Vector3d low = placed.front().x_in_world, high = low;
  for (const LivePosition& position : placed) {
    low = low.cwiseMin(position.x_in_world);
    high = high.cwiseMax(position.x_in_world);
  }
  return (high - low).maxCoeff();
}

LiveMap numbered(const LiveMap& before, LiveMap now) {
  const bool is_same_world = holds_all(now.placed, before.placed) && holds_all(now.odometry, before.odometry);
  static const LiveMap kNothing;
  const LiveMap& known = is_same_world ? before : kNothing;
  now.world = before.world + (is_same_world ? 0 : 1);
  now.last_change = before.last_change;
  const double tolerance = kVisibleShare * now.extent();
  number_track(known.placed, now.placed, tolerance, now.last_change);
  number_track(known.odometry, now.odometry, tolerance, now.last_change);
  number_loops(before.loops, now.loops, now.last_change);
  now.up = steady_vertical(known, now.placed);
  return now;
}

Eigen::Vector3d vertical_of(const Eigen::Matrix3Xd& positions) {
  if (positions.cols() < 3) return Eigen::Vector3d::UnitZ();
  const Eigen::Matrix3Xd x = positions.colwise() - Eigen::Vector3d(positions.rowwise().mean());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(x * x.transpose());
  const Eigen::Vector3d normal = axes.eigenvectors().col(0);
  constexpr double kNear = 0.8;
  for (const Eigen::Vector3d& usual : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, -1, 0)}) {
    if (std::abs(usual.dot(normal)) > kNear) return usual;
  }
  return normal.z() < 0.0 ? Eigen::Vector3d(-normal) : normal;
}

}  // namespace fabloop::apps
