// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "verification/pose/levenberg_marquardt.h"
#include "verification/pose/residuals.h"
#include "verification/rig/rig_pose.h"

namespace fabloop {

/// A pose of two bodies as the loop scores it: the rotation as a matrix.
struct BodyMotion {
  Eigen::Matrix3d rotation;     ///< match_from_query.
  Eigen::Vector3d translation;  ///< match_from_query.

  Pose pose() const { return {Eigen::Quaterniond(rotation).normalized(), translation}; }
  static BodyMotion from(const Pose& match_from_query) {
    return {match_from_query.rotation.toRotationMatrix(), match_from_query.translation};
  }
};

/// From the match's camera to the query's, in the match's body: b = t + R c - d.
inline Eigen::Vector3d baseline_in_match(const RigRayPair& pair, const BodyMotion& motion) {
  return motion.translation + motion.rotation * pair.query.origin_in_body - pair.match.origin_in_body;
}

/// Sampson distance of two rays of a rig on the unit spheres: the central one with the pair's own baseline b. The generalised
/// epipolar constraint (Pless 2003, eq. 14) is e = m . (b x R q) = 0, and |grad e|^2 = |b x R q|^2 + |b x m|^2 - 2 e^2.
struct RigResidual {
  double error = 0;          ///< e.
  double gradient_norm = 0;  ///< |grad e| over both unit spheres.
  Eigen::Vector3d baseline = Eigen::Vector3d::Zero();
  Eigen::Vector3d query_ray_in_match = Eigen::Vector3d::Zero();  ///< R q.
};

inline RigResidual rig_residual(const RigRayPair& pair, const BodyMotion& motion) {
  RigResidual residual;
  residual.baseline = baseline_in_match(pair, motion);
  residual.query_ray_in_match = motion.rotation * pair.query.ray_in_body;
  const Eigen::Vector3d from_query = residual.baseline.cross(residual.query_ray_in_match);
  const Eigen::Vector3d from_match = residual.baseline.cross(pair.match.ray_in_body);
  residual.error = pair.match.ray_in_body.dot(from_query);
  residual.gradient_norm =
      std::sqrt(std::max(0.0, from_query.squaredNorm() + from_match.squaredNorm() - 2.0 * residual.error * residual.error));
  return residual;
}

/// Below this baseline (in the unit of length, or as the sine between baseline and rays) there is no epipolar plane.
inline constexpr double kMinGradient = 1e-9;

/// The squared distance in radians; a pair without an epipolar plane agrees when its rays are parallel.
inline double squared_rig_error(const RigRayPair& pair, const BodyMotion& motion) {
  const RigResidual residual = rig_residual(pair, motion);
  if (residual.gradient_norm < kMinGradient) return (residual.query_ray_in_match - pair.match.ray_in_body).squaredNorm();
  const double distance = residual.error / residual.gradient_norm;
  return distance * distance;
}

/// Whether the rays meet in front of both cameras, or nearly so: parallel rays meet far away.
inline bool meets_in_front(const RigRayPair& pair, const BodyMotion& motion, double tolerance_rad) {
  const Eigen::Vector3d baseline = baseline_in_match(pair, motion);
  const RayDepths depths = ray_depths(motion.rotation * pair.query.ray_in_body, pair.match.ray_in_body, baseline);
  const double slack = -tolerance_rad * baseline.norm();
  return depths.match >= slack && depths.query >= slack;
}

/// Adds a pair's distance r = e / g, g = |grad e|, to the normal equations by (translation, rotation) in the query's axes. With
/// f = R q, n = f x m: de = n . db + (m x b) . df, and g dg = (2 b - (b . f) f - (b . m) m - 2 e n) . db - ((b . f) b + 2 e (m x
/// b)) . df. The derivative is whole: were g held constant, noise alone would seem to tell the length of b, on which r does not
/// depend.
inline void add_rig_residual(const RigRayPair& pair, const BodyMotion& motion, NormalEquations<6>& normal) {
  const RigResidual residual = rig_residual(pair, motion);
  const double e = residual.error, g = residual.gradient_norm;
  if (g < kMinGradient) return;
  const Eigen::Vector3d &b = residual.baseline, &f = residual.query_ray_in_match, &m = pair.match.ray_in_body;
  const Eigen::Vector3d n = f.cross(m), e_by_f = m.cross(b);
  const Eigen::Vector3d g_by_b = 2.0 * b - b.dot(f) * f - b.dot(m) * m - 2.0 * e * n;
  const Eigen::Vector3d g_by_f = -b.dot(f) * b - 2.0 * e * e_by_f;
  const double ratio = e / (g * g);
  const Eigen::Vector3d by_b = motion.rotation.transpose() * (n - ratio * g_by_b) / g;
  const Eigen::Vector3d by_f = motion.rotation.transpose() * (e_by_f - ratio * g_by_f) / g;
  Eigen::Matrix<double, 6, 1> jacobian;
  jacobian << by_b, pair.query.origin_in_body.cross(by_b) + pair.query.ray_in_body.cross(by_f);
  normal.hessian.noalias() += jacobian * jacobian.transpose();
  normal.gradient += e / g * jacobian;
  normal.cost += e * e / (g * g);
}

}  // namespace fabloop
