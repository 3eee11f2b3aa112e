// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/autodiff_cost_function.h>
#include <ceres/cost_function.h>
#include <ceres/rotation.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cassert>
#include <cmath>
#include <memory>

#include "posegraph/information.h"
#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"

/// The errors of edges, for Ceres. In 3-D a pose is two blocks: the quaternion in Eigen's storage (x y z w) and the
/// translation; in 2-D one block (x, y, yaw).
namespace fabloop::residuals {

template <typename T>
using Vector2 = Eigen::Matrix<T, 2, 1>;
template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <typename T>
using ConstQuaternion = Eigen::Map<const Eigen::Quaternion<T>>;
template <typename T>
using ConstVector3 = Eigen::Map<const Vector3<T>>;

/// Below this length [m] a predicted baseline has no direction, and the error fades to zero instead of dividing by it.
inline constexpr double kMinLength = 1e-6;

/// Rotation vector of a rotation, at most pi long.
template <typename T>
Vector3<T> rotation_vector(const Eigen::Quaternion<T>& rotation) {
  const T wxyz[4] = {rotation.w(), rotation.x(), rotation.y(), rotation.z()};
  Vector3<T> result;
  ceres::QuaternionToAngleAxis(wxyz, result.data());
  return result;
}

/// 2 vec(q), of the one of q and -q that turns less.
template <typename T>
Vector3<T> twice_vector_part(const Eigen::Quaternion<T>& rotation) {
  const T sign = rotation.w() < T(0) ? T(-2) : T(2);
  return sign * rotation.vec();
}

/// Error of a predicted translation against a measured unit direction d, on the plane across d (basis 3 x 2). Its length is
/// 2 sin(angle / 2): that of the chord, so that the opposite direction is worst.
template <typename T>
Vector2<T> direction_error(const Eigen::Vector3d& direction, const Eigen::Matrix<double, 3, 2>& basis,
                           const Vector3<T>& predicted) {
  const T squared_length = predicted.squaredNorm();
  const T length = squared_length > T(kMinLength * kMinLength) ? T(sqrt(squared_length)) : T(kMinLength);
  const Vector3<T> unit = predicted / length;
  const T one_plus_cos = T(1) + direction.cast<T>().dot(unit);
  constexpr double kMinOnePlusCos = 1e-6;
  const T denominator = one_plus_cos > T(kMinOnePlusCos) ? one_plus_cos : T(kMinOnePlusCos);
  return basis.transpose().cast<T>() * unit * T(sqrt(T(2) / denominator));
}

/// kappa |R_j - R_i R_ij|_F^2 + tau |t_j - t_i - R_i t_ij|^2; without scale the second term is tau |direction error|^2.
/// The first is written 8 kappa |vec(q)|^2 with q the error quaternion: the same number (8 kappa sin^2(angle / 2)) from three
/// rows in place of nine, and the second is turned into the frame of i: the same cost in fewer iterations.
class ChordalResidual {
 public:
  static constexpr int kSize = 6;

  explicit ChordalResidual(const Edge& edge) : i_from_j_(edge.from_from_to), has_scale_(edge.has_scale) {
    const ChordalWeights weights = chordal_weights(edge, 3);
    sqrt_tau_ = std::sqrt(weights.tau);
    sqrt_2_kappa_ = std::sqrt(2.0 * weights.kappa);
    if (!has_scale_) {
      i_from_j_.translation.normalize();
      basis_ = tangent_basis(i_from_j_.translation);
    }
  }

  template <typename T>
  bool operator()(const T* q_i, const T* t_i, const T* q_j, const T* t_j, T* residual) const {
    const Eigen::Quaternion<T> i_from_world = ConstQuaternion<T>(q_i).conjugate();
    const Eigen::Quaternion<T> j_from_i = i_from_j_.rotation.conjugate().cast<T>();
    const Vector3<T> baseline = ConstVector3<T>(t_j) - ConstVector3<T>(t_i);
    Eigen::Map<Vector3<T>> translation_error(residual);
    Eigen::Map<Vector3<T>> rotation_error(residual + 3);
    rotation_error = T(sqrt_2_kappa_) * twice_vector_part<T>(j_from_i * (i_from_world * ConstQuaternion<T>(q_j)));
    const Vector3<T> t_ij = i_from_world * baseline;
    if (has_scale_) {
      translation_error = T(sqrt_tau_) * (t_ij - i_from_j_.translation.cast<T>());
    } else {
      translation_error.template head<2>() = T(sqrt_tau_) * direction_error<T>(i_from_j_.translation, basis_, t_ij);
      translation_error(2) = T(0);
    }
    return true;
  }

 private:
  Pose i_from_j_;
  Eigen::Matrix<double, 3, 2> basis_ = Eigen::Matrix<double, 3, 2>::Zero();
  bool has_scale_;
  double sqrt_tau_ = 0.0;
  double sqrt_2_kappa_ = 0.0;
};

/// W e with e = (translation, rotation) of the error pose i_from_j_measured^-1 * i_from_j, as g2o defines it; without scale
/// the translation is the direction error, so W has two columns less for it than for a vector of three.
class WhitenedResidual {
 public:
  static constexpr int kSize = 6;

  WhitenedResidual(const Edge& edge, Objective objective)
      : i_from_j_(edge.from_from_to), objective_(objective), has_scale_(edge.has_scale) {
    if (has_scale_) {
      whitening_ = whitening(edge.information);
      return;
    }
    i_from_j_.translation.normalize();
    basis_ = tangent_basis(i_from_j_.translation);
    // The information is given in the frame of j, the direction lives in the frame of i.
    Eigen::Matrix<double, 6, 5> error_from_tangent = Eigen::Matrix<double, 6, 5>::Zero();
    error_from_tangent.block<3, 2>(0, 0) = i_from_j_.rotation.conjugate().toRotationMatrix() * basis_;
    error_from_tangent.block<3, 3>(3, 2).setIdentity();
    whitening_.setZero();
    whitening_.topLeftCorner<5, 5>() = whitening(error_from_tangent.transpose() * edge.information * error_from_tangent);
  }

  template <typename T>
  bool operator()(const T* q_i, const T* t_i, const T* q_j, const T* t_j, T* residual) const {
    const Eigen::Quaternion<T> i_from_world = ConstQuaternion<T>(q_i).conjugate();
    const Eigen::Quaternion<T> measured_inverse = i_from_j_.rotation.conjugate().cast<T>();
    const Vector3<T> t_ij = i_from_world * Vector3<T>(ConstVector3<T>(t_j) - ConstVector3<T>(t_i));
    const Eigen::Quaternion<T> rotation = measured_inverse * (i_from_world * ConstQuaternion<T>(q_j));
    const Vector3<T> rotation_error =
        objective_ == Objective::Quaternion ? twice_vector_part(rotation) : rotation_vector(rotation);
    Eigen::Matrix<T, 6, 1> error = Eigen::Matrix<T, 6, 1>::Zero();
    if (has_scale_) {
      error << measured_inverse * Vector3<T>(t_ij - i_from_j_.translation.cast<T>()), rotation_error;
    } else {
      error.template head<2>() = direction_error<T>(i_from_j_.translation, basis_, t_ij);
      error.template segment<3>(2) = rotation_error;
    }
    Eigen::Map<Eigen::Matrix<T, 6, 1>> whitened(residual);
    whitened.noalias() = whitening_.cast<T>() * error;
    return true;
  }

 private:
  Pose i_from_j_;
  Eigen::Matrix<double, 3, 2> basis_ = Eigen::Matrix<double, 3, 2>::Zero();
  Matrix6d whitening_;
  Objective objective_;
  bool has_scale_;
};

/// The planar edge under each objective; `e = (x, y, yaw)` of the error pose, or the chordal four rows.
class PlanarResidual {
 public:
  static constexpr int kSize = 4;

  PlanarResidual(const Edge& edge, Objective objective) : t_ij_(edge.from_from_to.translation.head<2>()), objective_(objective) {
    assert(edge.has_scale);
    const Eigen::Quaterniond& q = edge.from_from_to.rotation;
    yaw_ij_ = 2.0 * std::atan2(q.z(), q.w());
    const ChordalWeights weights = chordal_weights(edge, 2);
    sqrt_tau_ = std::sqrt(weights.tau);
    // Each of cos and sin stands twice in a 2 x 2 rotation.
    sqrt_2_kappa_ = std::sqrt(2.0 * weights.kappa);
    whitening_ = whitening(planar_information(edge.information));
  }

  template <typename T>
  bool operator()(const T* i, const T* j, T* residual) const {
    const Vector2<T> baseline(j[0] - i[0], j[1] - i[1]);
    const Eigen::Rotation2D<T> rotation_i(i[2]);
    Eigen::Map<Eigen::Matrix<T, 4, 1>> result(residual);
    if (objective_ == Objective::Chordal) {
      const T predicted = i[2] + T(yaw_ij_);
      result.template head<2>() = T(sqrt_tau_) * (baseline - rotation_i * t_ij_.cast<T>());
      result(2) = T(sqrt_2_kappa_) * (cos(j[2]) - cos(predicted));
      result(3) = T(sqrt_2_kappa_) * (sin(j[2]) - sin(predicted));
      return true;
    }
    const T yaw_error = j[2] - i[2] - T(yaw_ij_);
    const T wrapped = atan2(sin(yaw_error), cos(yaw_error));
    Vector3<T> error;
    error.template head<2>() =
        Eigen::Rotation2Dd(-yaw_ij_).toRotationMatrix().cast<T>() * Vector2<T>(rotation_i.inverse() * baseline - t_ij_.cast<T>());
    error(2) = objective_ == Objective::Quaternion ? T(T(2) * sin(T(0.5) * wrapped)) : wrapped;
    result.template head<3>() = whitening_.cast<T>() * error;
    result(3) = T(0);
    return true;
  }

 private:
  Eigen::Vector2d t_ij_;
  double yaw_ij_ = 0.0;
  Eigen::Matrix3d whitening_;
  Objective objective_;
  double sqrt_tau_ = 0.0;
  double sqrt_2_kappa_ = 0.0;
};

/// The residual of an edge: blocks (q_i, t_i, q_j, t_j) in 3-D, (pose_i, pose_j) in 2-D.
inline std::unique_ptr<ceres::CostFunction> make_residual(const Edge& edge, int dimension, Objective objective) {
  if (dimension == 2) {
    return std::make_unique<ceres::AutoDiffCostFunction<PlanarResidual, PlanarResidual::kSize, 3, 3>>(
        new PlanarResidual(edge, objective));
  }
  if (objective == Objective::Chordal) {
    return std::make_unique<ceres::AutoDiffCostFunction<ChordalResidual, ChordalResidual::kSize, 4, 3, 4, 3>>(
        new ChordalResidual(edge));
  }
  return std::make_unique<ceres::AutoDiffCostFunction<WhitenedResidual, WhitenedResidual::kSize, 4, 3, 4, 3>>(
      new WhitenedResidual(edge, objective));
}

}  // namespace fabloop::residuals
