// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "verification/pose/epipolar_equations.h"
#include "verification/pose/levenberg_marquardt.h"
#include "verification/pose/relative_pose.h"

namespace fabloop {

/// Two unit vectors that span the plane across `direction`.
Eigen::Matrix<double, 3, 2> direction_axes(const Eigen::Vector3d& direction);

EpipolarFrame frame_of(const Pose& match_from_query);

EpipolarEquations equations_of(std::span<const RayPair> pairs);

/// Of some of the pairs. Each counts as much as `weights` says, by its index in `pairs`: all alike where there are none.
EpipolarEquations equations_of(std::span<const RayPair> pairs, std::span<const std::size_t> indices,
                               std::span<const double> weights = {});

/// With respect to (rotation in the query frame, direction's tangent plane), radians.
NormalEquations<5> linearise(const EpipolarEquations& equations, const Pose& match_from_query);

/// Minimises the pairs' Sampson distances.
Pose minimise(const EpipolarEquations& equations, const Pose& match_from_query, int max_steps);

}  // namespace fabloop
