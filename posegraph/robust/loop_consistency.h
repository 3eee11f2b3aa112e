// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posegraph/pose_graph.h"
#include "posegraph/robust/odometry_tree.h"
#include "verification/uncertain_pose.h"

namespace fabloop {

/// Whether loops can be right together: the cycle of a loop, the odometry between their ends, the other loop, and the odometry
/// back is the identity within what all four may err (Mangelson et al., Pairwise Consistent Measurement Set Maximization, ICRA
/// 2018, eq. 6, with covariances propagated along the cycle).
class LoopConsistency {
 public:
  /// Right pairs pass with `probability`. The edges of the graph whose kind is in `doubted` are the loops. Noise is taken to be
  /// `noise_scale` times the variance that the information matrices tell.
  LoopConsistency(const PoseGraph& graph, const std::vector<EdgeKind>& doubted, double probability, double noise_scale = 1.0);

  /// Number of loops.
  std::size_t size() const { return loops_.size(); }

  /// Position in `PoseGraph::edges` of each loop, ascending.
  const std::vector<std::size_t>& edges() const { return edges_; }

  /// Squared Mahalanobis distance of the cycle of two loops (positions in edges()) from the identity. Where either has no scale,
  /// of its rotation alone. Infinite where it is beyond the threshold by the trace of the covariance alone. Zero where
  /// odometry does not close the cycle: nothing speaks against it.
  double chi2(std::size_t a, std::size_t b) const;

  /// Of chi2(): 6, or 3 for rotations; 3 or 1 in the plane.
  int degrees_of_freedom(std::size_t a, std::size_t b) const;

  /// Whether two loops can be right together.
  bool are_consistent(std::size_t a, std::size_t b) const;

  /// Squared Mahalanobis distance of a loop from what odometry alone says.
  double chi2_of_odometry(std::size_t a) const;

  /// How far a loop is from another measurement of the pose between its ends, those of the graph's edge: squared Mahalanobis
  /// distance in thresholds, so that they agree up to 1.
  double contradiction(std::size_t a, const UncertainPose& from_from_to) const;

  /// The loops nearest along the odometry, at most `count`: those with fewest steps between the starts and between the ends, and
  /// no more than `max_steps` of both. Nearest first.
  std::vector<std::size_t> nearest(std::size_t a, std::size_t count, std::size_t max_steps) const;

 private:
  /// A loop that starts at its earlier vertex.
  struct Loop {
    std::size_t from = 0, to = 0;
    bool has_scale = true;
    bool is_turned = false;  ///< The graph's edge starts at the later vertex.
    Pose from_from_to, to_from_root_by_loop;
    Matrix6d covariance, covariance_in_root;  ///< In the frame of `to`, and in that of the tree's root.
    double rotation_variance = 0.0;           ///< Trace of the rotation block, the same in every frame.
  };
  Loop make_loop(Edge edge) const;
  double mahalanobis(const Matrix6d& covariance, const Pose& error, bool has_scale) const;

  int dimension_;
  OdometryTree odometry_;
  std::vector<std::size_t> edges_;
  std::vector<Loop> loops_;
  std::vector<std::size_t> by_start_, place_by_start_;  ///< Loops in order of their starts, and where each stands there.
  double threshold_, threshold_of_rotation_;
};

/// By what the variances that the information matrices tell are to be multiplied, at most 1, for thresholds that mean something:
/// some published graphs and cautious front ends promise thousands of times less than they hold, and false loops would pass. It
/// is 100 times the lower quartile of the chi-square of each loop with a neighbour, over that of honest matrices: so it is below
/// 1 only where loops fit one another ten times better than they promise, and stays far above what they show. 1 with fewer than
/// 20 pairs to judge by.
double observed_noise_scale(const LoopConsistency& loops);

}  // namespace fabloop
