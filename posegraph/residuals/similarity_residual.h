// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "posegraph/information.h"
#include "posegraph/residuals/quaternion_jacobians.h"
#include "posegraph/similarity_graph.h"

namespace fabloop::residuals {

/// Seven errors of an edge between similarities over the blocks (q_i, p_i, q_j, p_j), p = (translation, log scale):
/// W (translation, rotation, log scale) of i_from_j^-1 * (world_from_i^-1 * world_from_j). The translation is computed in the
/// axes of i, in units of j as measured; whitening turns it into the axes of j, where information lives. Rotations as in
/// SpatialResidual.
class SimilarityResidual final : public ceres::SizedCostFunction<7, 4, 4, 4, 4> {
 public:
  SimilarityResidual(const SimilarityEdge& edge, Objective objective)
      : i_from_j_(edge.from_from_to), log_scale_(std::log(edge.from_from_to.scale)), objective_(objective) {
    if (objective == Objective::Chordal) {
      Edge rigid;
      rigid.information = edge.information.topLeftCorner<6, 6>();
      const ChordalWeights weights = chordal_weights(rigid, 3);
      whitening_.diagonal().head<3>().setConstant(std::sqrt(weights.tau));
      whitening_.diagonal().segment<3>(3).setConstant(std::sqrt(2.0 * weights.kappa));
      whitening_(6, 6) = std::sqrt(std::max(0.0, edge.information(6, 6)));
    } else {
      whitening_ = whitening(edge.information);
      whitening_.leftCols<3>() = whitening_.leftCols<3>() * i_from_j_.rotation.conjugate().toRotationMatrix();
    }
  }

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override {
    const Eigen::Map<const Eigen::Quaterniond> q_i(blocks[0]);
    const Eigen::Map<const Eigen::Vector4d> p_i(blocks[1]);
    const Eigen::Map<const Eigen::Quaterniond> q_j(blocks[2]);
    const Eigen::Map<const Eigen::Vector4d> p_j(blocks[3]);
    const Eigen::Vector3d baseline = p_j.head<3>() - p_i.head<3>();
    const Eigen::Matrix3d i_from_world = q_i.conjugate().toRotationMatrix();
    // World units to those of i, then to those of j as measured.
    const double j_by_world = std::exp(-p_i(3)) / i_from_j_.scale;
    const Eigen::Vector3d t_in_j_units = j_by_world * (i_from_world * baseline);
    const Eigen::Quaterniond j_from_i = i_from_j_.rotation.conjugate();
    const Eigen::Quaterniond j_from_world = j_from_i * q_i.conjugate();
    const Eigen::Quaterniond error_rotation = j_from_world * q_j;
    const RotationError rotation =
        objective_ == Objective::RotationVector ? rotation_vector(error_rotation) : twice_vector_part(error_rotation);

    Vector7d error;
    error << t_in_j_units - i_from_j_.translation / i_from_j_.scale, rotation.value, p_j(3) - p_i(3) - log_scale_;
    Eigen::Map<Vector7d>(residual).noalias() = whitening_ * error;
    if (jacobians == nullptr) return true;

    using Block = Eigen::Map<Eigen::Matrix<double, 7, 4, Eigen::RowMajor>>;
    const Eigen::Matrix<double, 7, 4> by_rotation = whitening_.middleCols<3>(3) * rotation.by_rotation;
    Eigen::Matrix<double, 7, 4> by_p_j;
    by_p_j << whitening_.leftCols<3>() * (j_by_world * i_from_world), whitening_.col(6);
    if (jacobians[0] != nullptr) {
      Eigen::Matrix4d error_by_q_i = left_product(j_from_i) * right_product(q_j);
      error_by_q_i.leftCols<3>() *= -1.0;
      Block{jacobians[0]} =
          whitening_.leftCols<3>() * (j_by_world * turned_back_by_rotation(q_i, baseline)) + by_rotation * error_by_q_i;
    }
    if (jacobians[1] != nullptr) {
      Block by_p_i(jacobians[1]);
      by_p_i = -by_p_j;
      by_p_i.col(3) -= whitening_.leftCols<3>() * t_in_j_units;
    }
    if (jacobians[2] != nullptr) Block{jacobians[2]} = by_rotation * left_product(j_from_world);
    if (jacobians[3] != nullptr) Block{jacobians[3]} = by_p_j;
    return true;
  }

 private:
  Similarity i_from_j_;
  double log_scale_;
  Objective objective_;
  Matrix7d whitening_ = Matrix7d::Zero();
};

}  // namespace fabloop::residuals
