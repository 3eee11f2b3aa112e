// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "posegraph/information.h"
#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"
#include "posegraph/residuals/direction_error.h"
#include "posegraph/residuals/quaternion_jacobians.h"

namespace fabloop::residuals {

/// Six errors of an edge in space over the blocks (q_i, t_i, q_j, t_j): W (translation, rotation), with W set by the objective.
/// The translation is compared in the frame of i; the whitened ones turn it into the frame of j, where information lives. Under
/// Chordal the translation's error in i's frame and 8 kappa |vec(q)|^2 = 8 kappa sin^2(angle / 2) give SE-Sync's cost in six
/// rows in place of twelve, and in fewer iterations than differences in the world's frame would take.
class SpatialResidual final : public ceres::SizedCostFunction<6, 4, 3, 4, 3> {
 public:
  SpatialResidual(const Edge& edge, Objective objective) : i_from_j_(edge.from_from_to), objective_(objective) {
    if (!edge.has_scale) {
      i_from_j_.translation.normalize();
      direction_.emplace(i_from_j_.translation);
    }
    if (objective == Objective::Chordal) {
      const ChordalWeights weights = chordal_weights(edge, 3);
      whitening_.diagonal().head<3>().setConstant(std::sqrt(weights.tau));
      whitening_.diagonal().tail<3>().setConstant(std::sqrt(2.0 * weights.kappa));
    } else if (direction_) {
      // The information is given in the frame of j, the direction lives in the frame of i.
      Eigen::Matrix<double, 6, 5> error_from_tangent = Eigen::Matrix<double, 6, 5>::Zero();
      error_from_tangent.block<3, 2>(0, 0) = i_from_j_.rotation.conjugate().toRotationMatrix() * direction_->basis();
      error_from_tangent.block<3, 3>(3, 2).setIdentity();
      const Eigen::MatrixXd w = whitening(error_from_tangent.transpose() * edge.information * error_from_tangent);
      whitening_.topLeftCorner<5, 2>() = w.leftCols<2>();
      whitening_.topRightCorner<5, 3>() = w.rightCols<3>();
    } else {
      whitening_ = whitening(edge.information);
      whitening_.leftCols<3>() = whitening_.leftCols<3>() * i_from_j_.rotation.conjugate().toRotationMatrix();
    }
  }

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override {
    const Eigen::Map<const Eigen::Quaterniond> q_i(blocks[0]);
    const Eigen::Map<const Eigen::Quaterniond> q_j(blocks[2]);
    const Eigen::Vector3d baseline = Eigen::Map<const Eigen::Vector3d>(blocks[3]) - Eigen::Map<const Eigen::Vector3d>(blocks[1]);
    const Eigen::Matrix3d i_from_world = q_i.conjugate().toRotationMatrix();
    const Eigen::Quaterniond j_from_i = i_from_j_.rotation.conjugate();
    const Eigen::Quaterniond j_from_world = j_from_i * q_i.conjugate();
    const Eigen::Quaterniond error_rotation = j_from_world * q_j;
    const RotationError rotation =
        objective_ == Objective::RotationVector ? rotation_vector(error_rotation) : twice_vector_part(error_rotation);

    Eigen::Matrix<double, 6, 1> error;
    error << i_from_world * baseline - i_from_j_.translation, rotation.value;
    Eigen::Matrix<double, 6, 3> by_translation = whitening_.leftCols<3>();
    if (direction_) {
      const DirectionError::Value direction = (*direction_)(i_from_world * baseline);
      error.head<3>() << direction.value, 0.0;
      by_translation = whitening_.leftCols<2>() * direction.by_translation;
    }
    Eigen::Map<Eigen::Matrix<double, 6, 1>>(residual).noalias() = whitening_ * error;
    if (jacobians == nullptr) return true;

    const Eigen::Matrix<double, 6, 4> by_rotation = whitening_.rightCols<3>() * rotation.by_rotation;
    if (jacobians[0] != nullptr) {
      Eigen::Matrix4d error_by_q_i = left_product(j_from_i) * right_product(q_j);
      error_by_q_i.leftCols<3>() *= -1.0;
      Eigen::Map<Eigen::Matrix<double, 6, 4, Eigen::RowMajor>>(jacobians[0]).noalias() =
          by_translation * turned_back_by_rotation(q_i, baseline) + by_rotation * error_by_q_i;
    }
    const Eigen::Matrix<double, 6, 3> by_t_j = by_translation * i_from_world;
    if (jacobians[1] != nullptr) Eigen::Map<Eigen::Matrix<double, 6, 3, Eigen::RowMajor>>{jacobians[1]} = -by_t_j;
    if (jacobians[2] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 6, 4, Eigen::RowMajor>>(jacobians[2]).noalias() = by_rotation * left_product(j_from_world);
    }
    if (jacobians[3] != nullptr) Eigen::Map<Eigen::Matrix<double, 6, 3, Eigen::RowMajor>>{jacobians[3]} = by_t_j;
    return true;
  }

 private:
  Pose i_from_j_;
  Objective objective_;
  std::optional<DirectionError> direction_;
  Matrix6d whitening_ = Matrix6d::Zero();
};

}  // namespace fabloop::residuals
