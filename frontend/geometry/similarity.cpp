// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/geometry/similarity.h"

#include <Eigen/LU>
#include <cmath>

namespace fabloop {
namespace {

/// W as the series sum of M^k / (k + 1)!, M = sigma I + [omega]x.
Eigen::Matrix3d series(const Eigen::Matrix3d& m) {
  constexpr int kTerms = 8;
  Eigen::Matrix3d term = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d sum = term;
  for (int k = 1; k <= kTerms; ++k) {
    term = (term * m / (k + 1)).eval();
    sum += term;
  }
  return sum;
}

/// W = a I + b [omega]x + c [omega]x^2, from the integrals of e^(sigma u) times 1, sin(u angle) and cos(u angle).
Eigen::Matrix3d integrated_rotation(const Eigen::Vector3d& omega, double sigma) {
  const double angle = omega.norm();
  // Within this the series has converged to rounding; beyond it the integrals lose hardly a digit.
  constexpr double kSmall = 0.03;
  if (std::hypot(sigma, angle) < kSmall) return series(sigma * Eigen::Matrix3d::Identity() + cross_matrix(omega));
  const double a = sigma == 0.0 ? 1.0 : std::expm1(sigma) / sigma;
  if (angle == 0.0) return a * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d cross = cross_matrix(omega / angle);
  const double scale = std::exp(sigma);
  const double squared = sigma * sigma + angle * angle;
  const double integral_of_sine = (scale * (sigma * std::sin(angle) - angle * std::cos(angle)) + angle) / squared;
  const double integral_of_cosine = (scale * (sigma * std::cos(angle) + angle * std::sin(angle)) - sigma) / squared;
  return a * Eigen::Matrix3d::Identity() + integral_of_sine * cross + (a - integral_of_cosine) * cross * cross;
}

/// Log of a rotation, at most pi long.
Eigen::Vector3d rotation_vector_of(const Eigen::Quaterniond& rotation) {
  const double sine = rotation.vec().norm();
  if (sine == 0.0) return Eigen::Vector3d::Zero();
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  return sign * rotation_angle(rotation) / sine * rotation.vec();
}

}  // namespace

Similarity similarity_from_log(const Vector7d& coordinates) {
  const Eigen::Vector3d omega = coordinates.segment<3>(3);
  const double sigma = coordinates(6);
  return {std::exp(sigma), rotation_from_vector(omega), integrated_rotation(omega, sigma) * coordinates.head<3>()};
}

Vector7d log_of(const Similarity& similarity) {
  const Eigen::Vector3d omega = rotation_vector_of(similarity.rotation);
  const double sigma = std::log(similarity.scale);
  Vector7d coordinates;
  coordinates << integrated_rotation(omega, sigma).partialPivLu().solve(similarity.translation), omega, sigma;
  return coordinates;
}

}  // namespace fabloop
