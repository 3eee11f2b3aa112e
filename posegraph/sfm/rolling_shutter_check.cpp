// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/rolling_shutter_check.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <cstddef>
#include <optional>

#include "posegraph/sfm/readout_equations.h"

namespace fabloop {
namespace {

/// The unknowns and how surely.
struct ReadoutEstimate {
  ReadoutVector step;
  ReadoutMatrix covariance;
};

/// Whether the unknowns can be told apart, to what rounding leaves of it.
bool is_determined(const ReadoutMatrix& information) {
  constexpr double kLeast = 1e-9;
  if (!(information.diagonal().minCoeff() > 0)) return false;
  const ReadoutVector unit = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<ReadoutMatrix> scaled(ReadoutMatrix(unit.asDiagonal() * information * unit.asDiagonal()));
  return scaled.vectorD().minCoeff() > kLeast;
}

/// The least squares of all images. The covariance is the jackknife's, by images (Bell & McCaffrey 2002, CR3): errors may be
/// alike within an image, and what an image says the unknowns follow, the more so the fewer they are. None where it takes all
/// images to tell the unknowns apart.
std::optional<ReadoutEstimate> solve(const ReadoutEquations& equations, const ReadoutMatrix& information,
                                     const ReadoutVector& score) {
  if (!is_determined(information)) return std::nullopt;
  ReadoutEstimate result;
  result.step = Eigen::LDLT<ReadoutMatrix>(information).solve(-score);
  result.covariance = ReadoutMatrix::Zero();
  for (std::size_t view = 0; view < equations.score.size(); ++view) {
    const ReadoutMatrix others = information - equations.information[view];
    if (!is_determined(others)) return std::nullopt;
    const ReadoutVector left = equations.score[view] + equations.information[view] * result.step;
    const ReadoutVector astray = Eigen::LDLT<ReadoutMatrix>(others).solve(left);
    result.covariance += astray * astray.transpose();
  }
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
  constexpr std::size_t kLeastViews = 2 * ReadoutVector::RowsAtCompileTime;
  if (!(check.px_per_s > 0) || equations.score.size() < kLeastViews) return check;
  std::optional<ReadoutEstimate> estimate = solve(equations, information, score);
  if (!estimate) return check;
  know_calibration(*estimate, options);
  check.readout_s = readout_s + estimate->step[0];
  check.sigma_s = std::sqrt(estimate->covariance(0, 0));
  check.readout_of_given_camera_s = readout_s - score[0] / information(0, 0);
  check.is_known = std::isfinite(check.readout_s) && check.sigma_s > 0;
  judge(check, options);
  return check;
}

void judge(RollingShutterCheck& check, const RollingShutterCheckOptions& options) {
  check.is_certain = check.is_known && std::abs(check.readout_s) > kCertainSigmas * check.sigma_s;
  check.is_relevant = check.is_certain && std::abs(check.shift_px()) > options.min_shift_px;
}

}  // namespace fabloop
