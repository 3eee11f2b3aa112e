// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "posegraph/information.h"
#include "posegraph/pose_graph.h"
#include "posegraph/residuals/direction_error.h"
#include "posegraph/residuals/quaternion_jacobians.h"

namespace fabloop::residuals {

/// Two errors of an attitude prior over the block q: the chord between the measured and the predicted up direction in the frame
/// of the vertex, whitened. Turning about the vertical costs nothing, however far.
class AttitudeResidual final : public ceres::SizedCostFunction<2, 4> {
 public:
  explicit AttitudeResidual(const VertexPrior& prior)
      : error_(prior.world_from_frame.rotation.conjugate() * Eigen::Vector3d::UnitZ()) {
    const Eigen::Vector3d up = prior.world_from_frame.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    // A small turn w of the frame moves up by -w x up: the turn that moves it by B a is (B a) x up.
    const Eigen::Matrix<double, 3, 2> turn_from_tangent = -cross_matrix(up) * error_.basis();
    whitening_ = whitening(turn_from_tangent.transpose() * prior.information.bottomRightCorner<3, 3>() * turn_from_tangent);
  }

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override {
    const Eigen::Map<const Eigen::Quaterniond> q(blocks[0]);
    const DirectionError::Value error = error_(q.conjugate().toRotationMatrix() * Eigen::Vector3d::UnitZ());
    Eigen::Map<Eigen::Vector2d>(residual).noalias() = whitening_ * error.value;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    Eigen::Map<Eigen::Matrix<double, 2, 4, Eigen::RowMajor>>(jacobians[0]).noalias() =
        whitening_ * error.by_translation * turned_back_by_rotation(q, Eigen::Vector3d::UnitZ());
    return true;
  }

 private:
  DirectionError error_;
  Eigen::Matrix2d whitening_;
};

}  // namespace fabloop::residuals
