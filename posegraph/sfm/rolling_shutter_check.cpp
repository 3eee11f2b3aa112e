// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/rolling_shutter_check.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <cstddef>
#include <optional>

#include "posegraph/sfm/readout_equations.h"

namespace fabloop {
namespace {

constexpr int kNumReadoutUnknowns = ReadoutVector::RowsAtCompileTime;

/// By how much scatter is larger than what unknowns leave of it.
double growth_by_unknowns(const ReadoutEquations& equations) {
  const double num_views = static_cast<double>(equations.score.size());
  return num_views / (num_views - kNumReadoutUnknowns);
}

/// The unknowns and how surely.
struct ReadoutEstimate {
  ReadoutVector step;
  ReadoutMatrix covariance;
};

/// How well a calibration is known, as an information on the unknowns; the readout is not.
ReadoutMatrix information_of_calibration(const RollingShutterCheckOptions& options) {
  ReadoutVector information;
  information << 0, options.affine_sigma, options.affine_sigma, options.focal_sigma, options.principal_point_sigma,
      options.principal_point_sigma, options.radial_sigma, options.decentring_sigma, options.decentring_sigma;
  information.tail<8>() = information.tail<8>().cwiseAbs2().cwiseInverse().eval();
  return information.asDiagonal();
}

/// Whether the unknowns can be told apart, to what rounding leaves of it.
bool is_determined(const ReadoutMatrix& information) {
  constexpr double kLeast = 1e-9;
  if (!(information.diagonal().minCoeff() > 0)) return false;
  const ReadoutVector unit = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<ReadoutMatrix> scaled(ReadoutMatrix(unit.asDiagonal() * information * unit.asDiagonal()));
  return scaled.vectorD().minCoeff() > kLeast;
}

/// What one image's score is away from what all say.
ReadoutVector left_of(const ReadoutEquations& equations, std::size_t view, const ReadoutVector& step) {
  return equations.score[view] + equations.information[view] * step;
}

/// The least squares of all images beside the calibration's errors measured as zero, which weigh as much as `variance` says that
/// the images' noise is. The covariance is the images' by the jackknife (Bell & McCaffrey 2002, CR3), since errors may be alike
/// within an image and an image says more of itself the fewer they are, and what the calibration's errors let pass. Simulated
/// flights still err by 1.25 (18 images) to 1.1 (36) times the jackknife's sigma: it is taken larger by the share of the unknowns
/// in the images.
std::optional<ReadoutEstimate> solve(const ReadoutEquations& equations, const ReadoutMatrix& information,
                                     const ReadoutVector& score, const ReadoutMatrix& of_calibration, double variance) {
  const ReadoutMatrix known = variance * of_calibration;
  const ReadoutMatrix both = information + known;
  const Eigen::LDLT<ReadoutMatrix> solver(both);
  ReadoutEstimate result;
  result.step = solver.solve(-score);
  const ReadoutMatrix half = solver.solve(ReadoutMatrix(variance * known));
  result.covariance = solver.solve(ReadoutMatrix(half.transpose()));
  for (std::size_t view = 0; view < equations.score.size(); ++view) {
    const ReadoutMatrix others = both - equations.information[view];
    if (!is_determined(others)) return std::nullopt;
    const ReadoutVector astray = Eigen::LDLT<ReadoutMatrix>(others).solve(left_of(equations, view, result.step));
    result.covariance += growth_by_unknowns(equations) * astray * astray.transpose();
  }
  return result;
}

/// What images and the knowledge of the calibration say together, weighed so that the readout is told best. The noise is what the
/// images' scores scatter by, in units of what the least squares alone would let them, and a few powers of ten of it are tried:
/// it is another for each unknown, but a whole covariance of so few images would pretend to know directions that it cannot.
std::optional<ReadoutEstimate> best_estimate(const ReadoutEquations& equations, const ReadoutMatrix& information,
                                             const ReadoutVector& score, const RollingShutterCheckOptions& options) {
  if (!is_determined(information)) return std::nullopt;
  const Eigen::LDLT<ReadoutMatrix> free(information);
  const ReadoutVector free_step = free.solve(-score);
  double scatter = 0;
  for (std::size_t view = 0; view < equations.score.size(); ++view) {
    const ReadoutVector left = left_of(equations, view, free_step);
    scatter += left.dot(free.solve(left));
  }
  const double variance = growth_by_unknowns(equations) * scatter / kNumReadoutUnknowns;
  const ReadoutMatrix of_calibration = information_of_calibration(options);
  std::optional<ReadoutEstimate> best;
  for (const double factor : {0.01, 0.1, 1.0, 10.0}) {
    const auto estimate = solve(equations, information, score, of_calibration, factor * variance);
    if (estimate && (!best || estimate->covariance(0, 0) < best->covariance(0, 0))) best = estimate;
  }
  return best;
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
  constexpr std::size_t kLeastViews = 2 * kNumReadoutUnknowns;
  if (!(check.px_per_s > 0) || equations.score.size() < kLeastViews) return check;
  std::optional<ReadoutEstimate> estimate = best_estimate(equations, information, score, options);
  if (!estimate) return check;
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
