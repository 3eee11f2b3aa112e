// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/rolling_shutter_check.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "posegraph/residuals/reprojection_cost.h"
#include "posegraph/robust_loss.h"
#include "verification/median.h"

namespace fabloop {
namespace {

constexpr int kViewSize = bundle::kViewSize;
constexpr int kNumUnknowns = 3;  // readout, ratio of the axes, skew
using Unknowns = Eigen::Matrix<double, kNumUnknowns, 1>;
using UnknownsSquare = Eigen::Matrix<double, kNumUnknowns, kNumUnknowns>;
using ViewBlock = Eigen::Matrix<double, kViewSize, kViewSize>;
using ViewByUnknowns = Eigen::Matrix<double, kViewSize, kNumUnknowns>;
using PointByUnknowns = Eigen::Matrix<double, 3, kNumUnknowns>;
constexpr std::size_t kAbsent = std::numeric_limits<std::size_t>::max();

/// A sighting's error and its derivatives, times the root of its robust weight.
struct LinearSighting {
  std::size_t view = 0;  ///< Among the placed.
  Eigen::Vector2d error = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, kViewSize> by_view = Eigen::Matrix<double, 2, kViewSize>::Zero();
  Eigen::Matrix<double, 2, 3> by_point = Eigen::Matrix<double, 2, 3>::Zero();
  Eigen::Matrix<double, 2, kNumUnknowns> by_unknowns = Eigen::Matrix<double, 2, kNumUnknowns>::Zero();
  double px_per_s = 0;
};

/// Least squares over readout and affine error, with poses and points eliminated exactly.
class ReadoutStep {
 public:
  ReadoutStep(const Scene& scene, const Segment& segment, const std::vector<CameraRate>& rates,
              const RollingShutterCheckOptions& options)
      : scene_(scene), segment_(segment), rates_(rates), options_(options), placed_(scene.views.size(), kAbsent) {
    for (std::size_t view = 0; view < scene.views.size(); ++view) {
      turned_.emplace_back(segment.world_from_cameras[view] ? segment.world_from_cameras[view]->rotation.normalized()
                                                            : Eigen::Quaterniond::Identity());
      if (!segment.world_from_cameras[view]) continue;
      placed_[view] = num_placed_++;
      centres_.push_back(segment.world_from_cameras[view]->translation);
    }
  }

  RollingShutterCheck run() {
    reduce();
    if (!solve_views()) return {};
    score();
    RollingShutterCheck check;
    check.px_per_s = median(std::move(px_per_s_));
    const Eigen::LDLT<UnknownsSquare> solver(information_);
    if (!(check.px_per_s > 0) || !(solver.vectorD().minCoeff() > 0)) return {};
    Unknowns step = solver.solve(-total_score());
    UnknownsSquare covariance = robust_covariance(solver, step);
    know_affine_error(step, covariance);
    check.readout_s = step[0];
    check.sigma_s = std::sqrt(covariance(0, 0));
    check.is_known = std::isfinite(check.readout_s) && check.sigma_s > 0;
    return check;
  }

 private:
  LinearSighting linear(const SegmentPoint& point, const TrackFeature& member) {
    const View& view = scene_.views[member.view];
    const Eigen::Vector2d pixel = pixel_of(scene_, member);
    const double share = readout_share(view.camera, pixel.y());
    const ReadoutMotion motion = segment_.readout_motions.empty() ? ReadoutMotion{} : segment_.readout_motions[member.view];
    const Eigen::Vector3d ray = rotation_from_vector(share * motion.turn) * view.rays[member.feature];
    const double focal_x = view.camera.fx / view.features.pixel_size;
    const double focal_y = view.camera.fy / view.features.pixel_size;
    const Eigen::Vector2d normalised = ray.head<2>() / ray.z();
    const bundle::PinholeError cost(turned_[member.view], focal_x, focal_y, normalised, share * motion.shift_in_world);
    LinearSighting result;
    result.view = placed_[member.view];
    Eigen::Matrix<double, kViewSize, 1> block = Eigen::Matrix<double, kViewSize, 1>::Zero();
    block.tail<3>() = centres_[result.view];
    Eigen::Matrix<double, 2, kViewSize, Eigen::RowMajor> by_view;
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
    const std::array<const double*, 2> blocks{block.data(), point.x_in_world.data()};
    std::array<double*, 2> derivatives{by_view.data(), by_point.data()};
    if (!cost.Evaluate(blocks.data(), result.error.data(), derivatives.data())) return {};
    // A row at `share` sees the camera moved on by its rate times share times readout: the derivative is that by the pose.
    Eigen::Matrix<double, kViewSize, 1> rate;
    rate << rates_[member.view].turn_per_s, rates_[member.view].velocity_in_world_per_s;
    const Eigen::Vector2d per_readout = by_view * rate;
    result.px_per_s = view.features.pixel_size * per_readout.norm();
    result.by_unknowns << share * per_readout, Eigen::Vector2d(0, focal_y * normalised.y()),
        Eigen::Vector2d(focal_x * normalised.y(), 0);
    const double root_weight =
        std::sqrt(robust_weight(RobustLoss::Cauchy, result.error.squaredNorm(), options_.loss_px * options_.loss_px));
    result.error *= root_weight;
    result.by_view = root_weight * by_view;
    result.by_point = root_weight * by_point;
    result.by_unknowns *= root_weight;
    return result;
  }

  std::vector<LinearSighting> sightings_of(std::size_t track) {
    std::vector<LinearSighting> sightings;
    for (const std::uint32_t i : segment_.points[track]->seen_by)
      sightings.push_back(linear(*segment_.points[track], scene_.tracks.tracks[track][i]));
    return sightings;
  }

  static std::optional<Eigen::Matrix3d> covariance_of_point(const std::vector<LinearSighting>& sightings) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    for (const LinearSighting& s : sightings) information += s.by_point.transpose() * s.by_point;
    const Eigen::LDLT<Eigen::Matrix3d> solver(information);
    if (!(solver.vectorD().minCoeff() > 0)) return std::nullopt;
    return solver.solve(Eigen::Matrix3d::Identity());
  }

  /// Normal equations of the views, points eliminated.
  void reduce() {
    right_.assign(num_placed_, ViewByUnknowns::Zero());
    for (std::size_t track = 0; track < segment_.points.size(); ++track) {
      if (!segment_.points[track]) continue;
      const std::vector<LinearSighting> sightings = sightings_of(track);
      const auto covariance = covariance_of_point(sightings);
      if (!covariance) continue;
      PointByUnknowns point_by_unknowns = PointByUnknowns::Zero();
      for (const LinearSighting& s : sightings) point_by_unknowns += s.by_point.transpose() * s.by_unknowns;
      for (const LinearSighting& a : sightings) {
        const Eigen::Matrix<double, kViewSize, 3> gain = a.by_view.transpose() * a.by_point * *covariance;
        right_[a.view] += a.by_view.transpose() * a.by_unknowns - gain * point_by_unknowns;
        blocks_.try_emplace({a.view, a.view}, ViewBlock::Zero()).first->second += a.by_view.transpose() * a.by_view;
        for (const LinearSighting& b : sightings) {
          if (b.view > a.view) continue;
          blocks_.try_emplace({a.view, b.view}, ViewBlock::Zero()).first->second -= gain * b.by_point.transpose() * b.by_view;
        }
        px_per_s_.push_back(a.px_per_s);
      }
    }
  }

  /// How the views follow the unknowns. The first view is held, and its distance to the farthest, since the world's place and
  /// unit are free.
  bool solve_views() {
    if (num_placed_ < 2) return false;
    std::size_t farthest = 1;
    for (std::size_t view = 2; view < num_placed_; ++view) {
      if ((centres_[view] - centres_[0]).norm() > (centres_[farthest] - centres_[0]).norm()) farthest = view;
    }
    const Eigen::Vector3d away = (centres_[farthest] - centres_[0]).normalized();
    ViewBlock& of_farthest = blocks_.at({farthest, farthest});
    const Eigen::Matrix3d hold = of_farthest.bottomRightCorner<3, 3>().trace() * away * away.transpose();
    of_farthest.bottomRightCorner<3, 3>() += hold;
    const auto size = static_cast<Eigen::Index>(kViewSize * (num_placed_ - 1));
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& [at, block] : blocks_) {
      if (at.first == 0 || at.second == 0) continue;
      for (int row = 0; row < kViewSize; ++row) {
        for (int column = 0; column < kViewSize; ++column) {
          entries.emplace_back(static_cast<int>(kViewSize * (at.first - 1)) + row,
                               static_cast<int>(kViewSize * (at.second - 1)) + column, block(row, column));
        }
      }
    }
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::Matrix<double, Eigen::Dynamic, kNumUnknowns> right(size, kNumUnknowns);
    for (std::size_t view = 1; view < num_placed_; ++view) right.middleRows<kViewSize>(offset(view)) = right_[view];
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver(matrix);
    if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0)) return false;
    const Eigen::Matrix<double, Eigen::Dynamic, kNumUnknowns> follow = solver.solve(right);
    follow_.assign(num_placed_, ViewByUnknowns::Zero());
    for (std::size_t view = 1; view < num_placed_; ++view) follow_[view] = follow.middleRows<kViewSize>(offset(view));
    return true;
  }

  static Eigen::Index offset(std::size_t view) { return static_cast<Eigen::Index>(kViewSize * (view - 1)); }

  /// Information and scores of the unknowns by view, with what views and points take up of them taken away.
  void score() {
    scores_.assign(num_placed_, Unknowns::Zero());
    informations_.assign(num_placed_, UnknownsSquare::Zero());
    for (std::size_t track = 0; track < segment_.points.size(); ++track) {
      if (!segment_.points[track]) continue;
      std::vector<LinearSighting> sightings = sightings_of(track);
      const auto covariance = covariance_of_point(sightings);
      if (!covariance) continue;
      PointByUnknowns of_point = PointByUnknowns::Zero();
      for (LinearSighting& s : sightings) {
        s.by_unknowns -= s.by_view * follow_[s.view];
        of_point += s.by_point.transpose() * s.by_unknowns;
      }
      of_point = *covariance * of_point;
      for (LinearSighting& s : sightings) {
        s.by_unknowns -= s.by_point * of_point;
        scores_[s.view] += s.by_unknowns.transpose() * s.error;
        informations_[s.view] += s.by_unknowns.transpose() * s.by_unknowns;
      }
    }
    for (const UnknownsSquare& information : informations_) information_ += information;
  }

  Unknowns total_score() const {
    Unknowns total = Unknowns::Zero();
    for (const Unknowns& score : scores_) total += score;
    return total;
  }

  UnknownsSquare robust_covariance(const Eigen::LDLT<UnknownsSquare>& solver, const Unknowns& step) const {
    UnknownsSquare scatter = UnknownsSquare::Zero();
    for (std::size_t view = 0; view < num_placed_; ++view) {
      const Unknowns left = scores_[view] + informations_[view] * step;
      scatter += left * left.transpose();
    }
    const UnknownsSquare half = solver.solve(scatter);
    return solver.solve(UnknownsSquare(half.transpose()));
  }

  /// Affine errors are small: measured as zero with their sigma.
  void know_affine_error(Unknowns& step, UnknownsSquare& covariance) const {
    const Eigen::Matrix2d measured =
        covariance.bottomRightCorner<2, 2>() + std::pow(options_.affine_sigma, 2) * Eigen::Matrix2d::Identity();
    const Eigen::Matrix<double, kNumUnknowns, 2> gain = covariance.rightCols<2>() * measured.inverse();
    step -= gain * Eigen::Vector2d(step.tail<2>());
    covariance -= UnknownsSquare(gain * covariance.bottomRows<2>());
  }

  const Scene& scene_;
  const Segment& segment_;
  const std::vector<CameraRate>& rates_;
  const RollingShutterCheckOptions& options_;
  std::deque<bundle::TurnedView> turned_;  ///< One a view of the scene.
  std::vector<std::size_t> placed_;        ///< Position among the placed of each view.
  std::size_t num_placed_ = 0;
  std::vector<Eigen::Vector3d> centres_;                             ///< Of the placed.
  std::map<std::pair<std::size_t, std::size_t>, ViewBlock> blocks_;  ///< Lower triangle.
  std::vector<ViewByUnknowns> right_, follow_;
  std::vector<double> px_per_s_;  ///< One a sighting.
  std::vector<Unknowns> scores_;
  std::vector<UnknownsSquare> informations_;
  UnknownsSquare information_ = UnknownsSquare::Zero();
};

}  // namespace

RollingShutterCheck check_rolling_shutter(const Scene& scene, const Segment& segment, const std::vector<CameraRate>& rates,
                                          double readout_s, const RollingShutterCheckOptions& options) {
  RollingShutterCheck check = ReadoutStep(scene, segment, rates, options).run();
  if (!check.is_known) return check;
  check.readout_s += readout_s;
  judge(check, options);
  return check;
}

void judge(RollingShutterCheck& check, const RollingShutterCheckOptions& options) {
  constexpr double kSigmas = 4.0;
  check.is_certain = std::abs(check.readout_s) > kSigmas * check.sigma_s;
  check.is_relevant = check.is_certain && std::abs(check.shift_px()) > options.min_shift_px;
}

}  // namespace fabloop
