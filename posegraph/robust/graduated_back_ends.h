// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posegraph/pose_graph.h"
#include "posegraph/robust/loop_roles.h"
#include "posegraph/robust/robust_optimize.h"

namespace fabloop {

/// Graduated non-convexity with the surrogate of the back end asked for, from the loops that chance does not make.
BackEndSolution solve_graduated(PoseGraph& graph, const LoopRoles& roles, const RobustOptions& options);

/// The same with truncated least squares, refined by refine_choice().
BackEndSolution solve_truncated(PoseGraph& graph, const LoopRoles& roles, const RobustOptions& options);

}  // namespace fabloop
