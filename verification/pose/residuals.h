// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// E with match^T E query = 0.
inline Eigen::Matrix3d essential_matrix(const Pose& match_from_query) {
  return cross_matrix(match_from_query.translation) * match_from_query.rotation.toRotationMatrix();
}

/// Sampson distance of a pair of rays on the unit sphere: e / |tangential gradient of e|, radians. See the README of this folder.
struct EpipolarResidual {
  Eigen::Vector3d from_query;  ///< E query
  Eigen::Vector3d from_match;  ///< E^T match
  double error = 0;            ///< match^T E query
  double gradient_norm = 0;

  double angle() const { return error / gradient_norm; }
};

inline EpipolarResidual epipolar_residual(const Eigen::Vector3d& query_ray, const Eigen::Vector3d& match_ray,
                                          const Eigen::Matrix3d& essential) {
  constexpr double kMinSquaredGradient = 1e-24;
  EpipolarResidual residual;
  residual.from_query.noalias() = essential * query_ray;
  residual.from_match.noalias() = essential.transpose() * match_ray;
  residual.error = match_ray.dot(residual.from_query);
  const double squared =
      residual.from_query.squaredNorm() + residual.from_match.squaredNorm() - 2.0 * residual.error * residual.error;
  residual.gradient_norm = std::sqrt(std::max(squared, kMinSquaredGradient));
  return residual;
}

/// Derivatives of EpipolarResidual::angle().
struct EpipolarJacobian {
  Eigen::Vector3d by_rotation;     ///< By a rotation vector in the query's axes, applied on the right.
  Eigen::Vector3d by_translation;  ///< By the translation, in the match's axes.
};

/// The whole derivative, that of the denominator included: leaving it out minimises another function, whose minimum lies off
/// by the square of the noise (Kanatani 1996, section 9.2 on the bias of reweighting).
inline EpipolarJacobian epipolar_jacobian(const EpipolarResidual& residual, const Eigen::Vector3d& query_ray,
                                          const Eigen::Vector3d& match_ray, const Eigen::Matrix3d& essential,
                                          const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  const Eigen::Vector3d turned = rotation * query_ray;
  const double inverse = 1.0 / residual.gradient_norm;
  const double angle = residual.error * inverse;
  const Eigen::Vector3d error_by_rotation = query_ray.cross(residual.from_match);
  const Eigen::Vector3d error_by_translation = turned.cross(match_ray);
  const Eigen::Vector3d norm_by_rotation =
      query_ray.cross(Eigen::Vector3d(essential.transpose() * residual.from_query)) - 2.0 * residual.error * error_by_rotation;
  const Eigen::Vector3d norm_by_translation = turned.cross(residual.from_query) + match_ray.cross(translation.cross(match_ray)) -
                                              2.0 * residual.error * error_by_translation;
  return {inverse * (error_by_rotation - angle * inverse * norm_by_rotation),
          inverse * (error_by_translation - angle * inverse * norm_by_translation)};
}

/// Where two rays come closest, along each: least squares of depth_match match - depth_query query_ray = translation.
struct RayDepths {
  double query = 0;         ///< In the unit of the translation, times `squared_sine`.
  double match = 0;         ///< As `query`.
  double squared_sine = 0;  ///< Of the angle between the rays: 0 for parallel ones, which have no depth.
};

/// `query_ray` is turned into the match's axes.
inline RayDepths ray_depths(const Eigen::Vector3d& query_ray, const Eigen::Vector3d& match_ray,
                            const Eigen::Vector3d& translation) {
  const double cosine = query_ray.dot(match_ray);
  const double a = match_ray.dot(translation);
  const double b = query_ray.dot(translation);
  return {cosine * a - b, a - cosine * b, query_ray.cross(match_ray).squaredNorm()};
}

/// What a point's direction lies off a ray, in two axes across the ray: sines of angles.
struct DirectionResidual {
  Eigen::Vector2d value;
  Eigen::Matrix<double, 2, 3> by_point;  ///< Derivative by the point in the ray's camera.
};

inline DirectionResidual direction_residual(const Eigen::Vector3d& x_in_camera, const Eigen::Vector3d& ray) {
  const double distance = x_in_camera.norm();
  const Eigen::Vector3d direction = x_in_camera / distance;
  Eigen::Matrix<double, 2, 3> across;
  across.row(0) = ray.unitOrthogonal().transpose();
  across.row(1) = ray.cross(Eigen::Vector3d(across.row(0).transpose())).transpose();
  return {across * direction, across * (Eigen::Matrix3d::Identity() - direction * direction.transpose()) / distance};
}

}  // namespace fabloop
