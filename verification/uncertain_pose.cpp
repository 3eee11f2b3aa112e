// SPDX-License-Identifier: BSD-3-Clause
#include "verification/uncertain_pose.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace fabloop {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// What a host prints with nine digits still counts as symmetric, and a zero eigenvalue comes back as one this small.
constexpr double kRounding = 1e-9;
/// An eigenvalue of this share of the largest is what arithmetic leaves of zero; metres and radians may differ by more than
/// print.
constexpr double kNoInformation = 1e-13;

Matrix6d transformed(const Matrix6d& jacobian, const Matrix6d& covariance) {
  const Matrix6d result = jacobian * covariance * jacobian.transpose();
  return 0.5 * (result + result.transpose());
}

}  // namespace

Matrix6d adjoint(const Pose& a_from_b) {
  const Eigen::Matrix3d rotation = a_from_b.rotation.toRotationMatrix();
  Matrix6d result = Matrix6d::Zero();
  result.topLeftCorner<3, 3>() = rotation;
  result.topRightCorner<3, 3>() = cross_matrix(a_from_b.translation) * rotation;
  result.bottomRightCorner<3, 3>() = rotation;
  return result;
}

UncertainPose operator*(const UncertainPose& a_from_b, const UncertainPose& b_from_c) {
  return {a_from_b.pose * b_from_c.pose,
          transformed(adjoint(b_from_c.pose.inverse()), a_from_b.covariance) + b_from_c.covariance};
}

UncertainPose inverse(const UncertainPose& a_from_b) {
  return {a_from_b.pose.inverse(), transformed(adjoint(a_from_b.pose), a_from_b.covariance)};
}

double relative_distance_sigma(const UncertainPose& a_from_b) {
  const double distance = a_from_b.pose.translation.norm();
  if (distance == 0.0) return std::numeric_limits<double>::infinity();
  const Eigen::Vector3d direction_in_b = a_from_b.pose.rotation.conjugate() * a_from_b.pose.translation / distance;
  const double variance = direction_in_b.dot(a_from_b.covariance.topLeftCorner<3, 3>() * direction_in_b);
  return std::sqrt(std::max(0.0, variance)) / distance;
}

Eigen::Matrix<double, 6, 1> pose_error(const Pose& pose, const Pose& other) {
  const Pose error = pose.inverse() * other;
  Eigen::Matrix<double, 6, 1> result;
  result << error.translation, vector_from_rotation(error.rotation);
  return result;
}

Matrix6d covariance_of(const Matrix6d& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information);
  Eigen::Matrix<double, 6, 1> variances = Eigen::Matrix<double, 6, 1>::Zero();
  const double least = kNoInformation * eigen.eigenvalues().maxCoeff();
  for (int i = 0; i < 6; ++i) {
    if (eigen.eigenvalues()(i) > least) variances(i) = 1.0 / eigen.eigenvalues()(i);
  }
  return eigen.eigenvectors() * variances.asDiagonal() * eigen.eigenvectors().transpose();
}

bool is_covariance(const Matrix6d& matrix) {
  if (!matrix.allFinite()) return false;
  const double allowed = kRounding * matrix.cwiseAbs().maxCoeff();
  if ((matrix - matrix.transpose()).cwiseAbs().maxCoeff() > allowed) return false;
  return Eigen::SelfAdjointEigenSolver<Matrix6d>(matrix, Eigen::EigenvaluesOnly).eigenvalues().minCoeff() >= -allowed;
}

}  // namespace fabloop
