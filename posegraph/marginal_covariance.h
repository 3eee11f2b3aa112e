// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"

namespace fabloop {

/// How well poses are known, given all edges: the rows and columns of these vertices in the inverse of the whole information
/// matrix at the poses as they stand (which should be those of the optimum), 6 for each vertex in the order asked. A pose's error
/// e is (translation, rotation) in its own frame: world_from_frame_true = world_from_frame * Exp(e); planar graphs have zeros for
/// z, roll and pitch. Relative to the vertices that optimize() holds, whose own covariance is zero. Edges count with their robust
/// weight under `options`. Take Objective::RotationVector where the information matrices are real ones. Throws InputError for a
/// vertex that is not there, for a graph with priors, which it does not know, and where the edges do not determine the poses (a
/// part of the graph without scale, say).
Eigen::MatrixXd marginal_covariance(const PoseGraph& graph, const std::vector<std::size_t>& vertices,
                                    const OptimizeOptions& options = {});

}  // namespace fabloop
