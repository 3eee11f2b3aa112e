// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// A pose a_from_b and how well it is known: the covariance of the error E in a_from_b_true = a_from_b * E, whose coordinates
/// are (translation, rotation vector) in b's axes, as in a pose graph's edges.
struct UncertainPose {
  Pose pose;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// Ad(a_from_b), 6 x 6: an error (translation, rotation) in b's axes as it is seen from a, to first order (Barfoot & Furgale,
/// T-RO 2014, with the translation first).
Eigen::Matrix<double, 6, 6> adjoint(const Pose& a_from_b);

/// a_from_c. The errors of the two must be independent. First order (Barfoot & Furgale, T-RO 2014).
UncertainPose operator*(const UncertainPose& a_from_b, const UncertainPose& b_from_c);

/// b_from_a.
UncertainPose inverse(const UncertainPose& a_from_b);

/// Standard deviation of the distance between the two over that distance; infinite where they are at one place.
double relative_distance_sigma(const UncertainPose& a_from_b);

/// The error E that leads from one estimate of a pose to another: other = pose * E; (translation, rotation vector).
Eigen::Matrix<double, 6, 1> pose_error(const Pose& pose, const Pose& other);

/// The covariance of an information matrix. A direction without information gets none: where a loop has no scale, its unit
/// direction has no error along itself.
Eigen::Matrix<double, 6, 6> covariance_of(const Eigen::Matrix<double, 6, 6>& information);

/// Whether a matrix may be a covariance: finite, symmetric, no negative eigenvalue, rounding apart.
bool is_covariance(const Eigen::Matrix<double, 6, 6>& matrix);

}  // namespace fabloop
