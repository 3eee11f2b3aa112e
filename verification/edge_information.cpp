// SPDX-License-Identifier: BSD-3-Clause
#include "verification/edge_information.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace fabloop {
namespace {

using Matrix5d = Eigen::Matrix<double, 5, 5>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kUnmodelledRotationRad = 0.003;
constexpr double kUnmodelledTranslation = 0.01;  ///< Share of the median depth.
constexpr double kUnmodelledDirectionRad = 0.01;
/// Keeps a rank-deficient Hessian invertible; the resulting sigma is so large that the gates on it fail.
constexpr double kRelativeRidge = 1e-9;

template <typename Covariance>
double largest_sigma(const Covariance& covariance) {
  using Matrix = typename Covariance::PlainObject;
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

template <typename Matrix>
Matrix inverted(const Matrix& information) {
  return (information + kRelativeRidge * information.trace() * Matrix::Identity()).inverse();
}

Matrix6d symmetric(const Matrix6d& matrix) { return 0.5 * (matrix + matrix.transpose()); }

}  // namespace

EdgeInformation metric_edge_information(const Pose& match_from_query, const Matrix6d& covariance, double median_depth,
                                        double scale_sigma) {
  EdgeInformation edge;
  edge.rotation_sigma_rad = largest_sigma(covariance.bottomRightCorner<3, 3>());
  edge.translation_sigma = largest_sigma(covariance.topLeftCorner<3, 3>());
  const Eigen::Vector3d baseline_in_query = match_from_query.rotation.conjugate() * match_from_query.translation;
  const double unmodelled_translation = kUnmodelledTranslation * median_depth;
  Matrix6d widened = covariance;
  widened.topLeftCorner<3, 3>() += unmodelled_translation * unmodelled_translation * Eigen::Matrix3d::Identity() +
                                   scale_sigma * scale_sigma * baseline_in_query * baseline_in_query.transpose();
  widened.bottomRightCorner<3, 3>() += kUnmodelledRotationRad * kUnmodelledRotationRad * Eigen::Matrix3d::Identity();
  edge.information = symmetric(widened.inverse());
  return edge;
}

Matrix6d scaled_covariance(const RelativePose& relative, double baseline, double relative_sigma) {
  const Eigen::Matrix3d query_from_match = relative.match_from_query.rotation.conjugate().toRotationMatrix();
  Eigen::Matrix<double, 6, 5> from_relative = Eigen::Matrix<double, 6, 5>::Zero();
  from_relative.bottomLeftCorner<3, 3>().setIdentity();
  from_relative.topRightCorner<3, 2>() = baseline * query_from_match * relative.direction_basis;
  Matrix6d covariance = from_relative * inverted(relative.information) * from_relative.transpose();
  const Eigen::Vector3d along = query_from_match * relative.match_from_query.translation * (baseline * relative_sigma);
  covariance.topLeftCorner<3, 3>() += along * along.transpose();
  return covariance;
}

EdgeInformation direction_edge_information(const RelativePose& relative) {
  Matrix5d covariance = inverted(relative.information);
  EdgeInformation edge;
  edge.rotation_sigma_rad = largest_sigma(covariance.topLeftCorner<3, 3>());
  edge.translation_sigma = largest_sigma(covariance.bottomRightCorner<2, 2>());
  covariance.topLeftCorner<3, 3>() += kUnmodelledRotationRad * kUnmodelledRotationRad * Eigen::Matrix3d::Identity();
  covariance.bottomRightCorner<2, 2>() += kUnmodelledDirectionRad * kUnmodelledDirectionRad * Eigen::Matrix2d::Identity();
  // From (rotation, tangent plane in the match) to (translation in the query, rotation).
  Eigen::Matrix<double, 5, 6> from_edge = Eigen::Matrix<double, 5, 6>::Zero();
  from_edge.topRightCorner<3, 3>().setIdentity();
  from_edge.bottomLeftCorner<2, 3>() =
      relative.direction_basis.transpose() * relative.match_from_query.rotation.toRotationMatrix();
  edge.information = symmetric(from_edge.transpose() * covariance.inverse() * from_edge);
  return edge;
}

Matrix6d without_scale(const Matrix6d& information, const Pose& match_from_query) {
  const double distance = match_from_query.translation.norm();
  const Eigen::Vector3d direction_in_query = match_from_query.rotation.conjugate() * match_from_query.translation / distance;
  Matrix6d covariance = information.inverse();
  // Errors of the distance do not count; those across it are angles.
  Matrix6d across = Matrix6d::Identity();
  across.topLeftCorner<3, 3>() = (Eigen::Matrix3d::Identity() - direction_in_query * direction_in_query.transpose()) / distance;
  covariance = (across * covariance * across.transpose()).eval();
  // A unit of variance along the direction makes it invertible, and is taken out again.
  Matrix6d along = Matrix6d::Zero();
  along.topLeftCorner<3, 3>() = direction_in_query * direction_in_query.transpose();
  return symmetric((covariance + along).inverse() - along);
}

}  // namespace fabloop
