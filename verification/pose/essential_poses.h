// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <array>

#include "frontend/geometry/pose.h"

namespace fabloop {

/// The four poses of an essential matrix [t]x R (Hartley & Zisserman 2004, result 9.19), translations of unit length.
inline std::array<Pose, 4> essential_poses(const Eigen::Matrix3d& essential) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(essential, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  Eigen::Matrix3d v = svd.matrixV();
  if (u.determinant() < 0) u = -u;
  if (v.determinant() < 0) v = -v;
  const Eigen::Matrix3d w = (Eigen::Matrix3d() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished();
  const auto a = Eigen::Quaterniond(Eigen::Matrix3d(u * w * v.transpose())).normalized();
  const auto b = Eigen::Quaterniond(Eigen::Matrix3d(u * w.transpose() * v.transpose())).normalized();
  const Eigen::Vector3d direction = u.col(2);
  return {Pose{a, direction}, Pose{a, -direction}, Pose{b, direction}, Pose{b, -direction}};
}

}  // namespace fabloop
