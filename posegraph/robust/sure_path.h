// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "posegraph/pose_graph.h"
#include "verification/uncertain_pose.h"

namespace fabloop {

/// The surest way between two vertices of a graph: the path on which edges err least in sum, each axis in units of what odometry
/// errs in a step.
class SurePaths {
 public:
  /// Over the edges with scale whose kind is not in `doubted`.
  SurePaths(const PoseGraph& graph, const std::vector<EdgeKind>& doubted);

  /// Takes in one more edge (a position in the graph); nothing happens where it has no scale.
  void add(std::size_t edge);

  /// Leaves an edge out again.
  void remove(std::size_t edge);

  /// Pose of `to` in `from` along the surest path; none where no path leads there.
  std::optional<UncertainPose> find(std::size_t from, std::size_t to) const;

 private:
  struct Hop {
    std::size_t vertex = 0, edge = 0;
    double length = 0.0;
  };
  double length_of(const Matrix6d& covariance) const;
  UncertainPose follow(std::size_t from, const std::vector<std::size_t>& edges) const;

  const PoseGraph& graph_;                               ///< Must outlive this.
  double step_translation_ = 0.0, step_rotation_ = 0.0;  ///< Mean traces of the covariance of a trusted edge.
  std::vector<std::vector<Hop>> hops_;
};

}  // namespace fabloop
