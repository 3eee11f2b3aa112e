// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/rolling_shutter_check.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <cstddef>

#include "posegraph/sfm/readout_equations.h"

namespace fabloop {
namespace {

/// The unknowns and how surely.
struct ReadoutEstimate {
  ReadoutVector step;
  ReadoutMatrix covariance;
};

/// The least squares of all images. The covariance is what the images' scores scatter by (Liang & Zeger 1986): errors may be
/// alike within an image.
ReadoutEstimate solve(const ReadoutEquations& equations, const Eigen::LDLT<ReadoutMatrix>& total, const ReadoutVector& score) {
  ReadoutEstimate result;
  result.step = total.solve(-score);
  ReadoutMatrix scatter = ReadoutMatrix::Zero();
  for (std::size_t view = 0; view < equations.score.size(); ++view) {
    const ReadoutVector left = equations.score[view] + equations.information[view] * result.step;
    scatter += left * left.transpose();
  }
  const ReadoutMatrix half = total.solve(scatter);
  result.covariance = total.solve(ReadoutMatrix(half.transpose()));
  return result;
}

/// Takes in how well a calibration is known: what it may have wrong, measured as zero.
void know_calibration(ReadoutEstimate& estimate, const RollingShutterCheckOptions& options) {
  constexpr int kNum = ReadoutVector::RowsAtCompileTime - 1;
  Eigen::Matrix<double, kNum, 1> sigma;
  sigma << options.affine_sigma, options.affine_sigma, options.focal_sigma, options.principal_point_sigma,
      options.principal_point_sigma, options.radial_sigma, options.decentring_sigma, options.decentring_sigma;
  Eigen::Matrix<double, kNum, kNum> measured = estimate.covariance.bottomRightCorner<kNum, kNum>();
  measured.diagonal() += sigma.cwiseAbs2();
  const Eigen::Matrix<double, kNum + 1, kNum> gain = measured.ldlt().solve(estimate.covariance.bottomRows<kNum>()).transpose();
  estimate.step -= gain * Eigen::Matrix<double, kNum, 1>(estimate.step.tail<kNum>());
  estimate.covariance -= ReadoutMatrix(gain * estimate.covariance.bottomRows<kNum>());
}

/// Whether the unknowns can be told apart, to what rounding leaves of it.
bool is_determined(const ReadoutMatrix& information) {
  constexpr double kLeast = 1e-9;
  const ReadoutVector unit = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<ReadoutMatrix> scaled(ReadoutMatrix(unit.asDiagonal() * information * unit.asDiagonal()));
  return scaled.vectorD().minCoeff() > kLeast;
}

}  // namespace

RollingShutterCheck check_rolling_shutter(const Scene& scene, const Segment& segment, const std::vector<CameraRate>& rates,
                                          double readout_s, const RollingShutterCheckOptions& options) {
  const ReadoutEquations equations = readout_equations(scene, segment, rates, options.loss_px);
  RollingShutterCheck check;
  check.px_per_s = equations.px_per_s;
  ReadoutMatrix information = ReadoutMatrix::Zero();
  ReadoutVector score = ReadoutVector::Zero();
  for (std::size_t view = 0; view < equations.score.size(); ++view) {
    information += equations.information[view];
    score += equations.score[view];
  }
  if (!(check.px_per_s > 0) || !is_determined(information)) return check;
  ReadoutEstimate estimate = solve(equations, Eigen::LDLT<ReadoutMatrix>(information), score);
  know_calibration(estimate, options);
  check.readout_s = readout_s + estimate.step[0];
  check.sigma_s = std::sqrt(estimate.covariance(0, 0));
  check.readout_of_given_camera_s = readout_s - score[0] / information(0, 0);
  check.is_known = std::isfinite(check.readout_s) && check.sigma_s > 0;
  judge(check, options);
  return check;
}

void judge(RollingShutterCheck& check, const RollingShutterCheckOptions& options) {
  constexpr double kSigmas = 4.0;
  check.is_certain = check.is_known && std::abs(check.readout_s) > kSigmas * check.sigma_s;
  check.is_relevant = check.is_certain && std::abs(check.shift_px()) > options.min_shift_px;
}

}  // namespace fabloop
