// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"

namespace fabloop {

/// What solve_with_switches() is given; one entry an edge.
struct SwitchableProblem {
  std::vector<double> weights;   ///< 0: left out. Otherwise 1.
  std::vector<bool> has_switch;  ///< The edges that a switch may turn off.
  std::vector<double> c2;        ///< Penalty of a switch that is off: (1 - s)^2 c2.
};

/// What solve_with_switches() found.
struct SwitchableResult {
  OptimizeReport solve;
  std::vector<double> weights;  ///< s^2: the part of each edge's information that counts.
};

/// Poses and switches together: the sum of chi2 over edges without a switch, and of s^2 chi2 + (1 - s)^2 c2 over those with one,
/// s in [0, 1] and 1 to begin with (Suenderhauf & Protzel, Switchable Constraints for Robust Pose Graph SLAM, IROS 2012, eq. 7,
/// with the linear switch function).
SwitchableResult solve_with_switches(PoseGraph& graph, const SwitchableProblem& problem, const OptimizeOptions& options);

}  // namespace fabloop
