// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cassert>
#include <cmath>

#include "posegraph/information.h"
#include "posegraph/optimize.h"
#include "posegraph/pose_graph.h"

namespace fabloop::residuals {

/// Three errors of an edge in the plane over the blocks (x, y, yaw) of i and j: as SpatialResidual, without what the plane has
/// not.
class PlanarResidual final : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  PlanarResidual(const Edge& edge, Objective objective) : t_ij_(edge.from_from_to.translation.head<2>()), objective_(objective) {
    assert(edge.has_scale);
    const Eigen::Quaterniond& q = edge.from_from_to.rotation;
    yaw_ij_ = 2.0 * std::atan2(q.z(), q.w());
    if (objective == Objective::Chordal) {
      const ChordalWeights weights = chordal_weights(edge, 2);
      whitening_.diagonal() << std::sqrt(weights.tau), std::sqrt(weights.tau), std::sqrt(2.0 * weights.kappa);
    } else {
      whitening_ = whitening(planar_information(edge.information));
      whitening_.leftCols<2>() = whitening_.leftCols<2>() * Eigen::Rotation2Dd(-yaw_ij_).toRotationMatrix();
    }
  }

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override {
    const double* const i = blocks[0];
    const double* const j = blocks[1];
    const Eigen::Matrix2d i_from_world = Eigen::Rotation2Dd(-i[2]).toRotationMatrix();
    const Eigen::Vector2d translation = i_from_world * Eigen::Vector2d(j[0] - i[0], j[1] - i[1]);
    const double yaw_error = std::remainder(j[2] - i[2] - yaw_ij_, 2.0 * kPi);
    const bool is_angle = objective_ == Objective::RotationVector;
    Eigen::Vector3d error;
    error << translation - t_ij_, is_angle ? yaw_error : 2.0 * std::sin(0.5 * yaw_error);
    Eigen::Map<Eigen::Vector3d>(residual).noalias() = whitening_ * error;
    if (jacobians == nullptr) return true;

    Eigen::Matrix3d by_j = Eigen::Matrix3d::Zero();
    by_j.topLeftCorner<2, 2>() = i_from_world;
    by_j(2, 2) = is_angle ? 1.0 : std::cos(0.5 * yaw_error);
    if (jacobians[0] != nullptr) {
      Eigen::Matrix3d by_i = -by_j;
      by_i.topRightCorner<2, 1>() << translation.y(), -translation.x();
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(jacobians[0]).noalias() = whitening_ * by_i;
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(jacobians[1]).noalias() = whitening_ * by_j;
    }
    return true;
  }

 private:
  Eigen::Vector2d t_ij_;
  double yaw_ij_ = 0.0;
  Objective objective_;
  Eigen::Matrix3d whitening_ = Eigen::Matrix3d::Zero();
};

}  // namespace fabloop::residuals
